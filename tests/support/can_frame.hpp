// A CAN frame written out by its bytes.
#pragma once

#include <cstdint>
#include <initializer_list>

#include "curbline/can/frame.hpp"

namespace curbline::test {

inline can::Frame frame(std::uint32_t id, bool extended, std::initializer_list<std::uint8_t> bytes) {
  can::Frame f;
  f.id = id;
  f.extended = extended;
  for (const std::uint8_t byte : bytes) f.data[f.length++] = byte;
  return f;
}

}  // namespace curbline::test
