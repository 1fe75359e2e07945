// Which frames of a bus are wanted: what a port passes to the controller, or to the system. Plain data.
#pragma once

#include <cstdint>

#include "curbline/can/frame.hpp"
#include "curbline/can/signal.hpp"

namespace curbline::can {

/// Data frames whose id agrees with `id` in the bits of `mask`, of 11 bits or of 29, not both. Remote requests never
/// pass.
struct Filter {
  std::uint32_t id = 0;
  std::uint32_t mask = highest_id(true);
  bool extended = false;
};

/// The frames of a signal, and others of its id: decode() tells them apart.
constexpr Filter filter_of(const Signal& signal) {
  return {signal.id, signal.id_mask, signal.extended};
}

}  // namespace curbline::can
