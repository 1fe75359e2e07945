// How all stages number a cell's place, directions to its neighbours, and its plane. Number types are as small as the
// limits allow.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "curbline/limits.hpp"

namespace curbline {

/// Where the memory of a cell lies, in any stage that stores something for it (window.hpp).
template <Limits limits>
using Slot = std::conditional_t<(limits.rows * limits.cols < 65535), std::uint16_t, std::uint32_t>;

/// Number of a plane, at most 254; `no_label` means none.
using Label = std::uint8_t;
inline constexpr Label no_label = 255;

/// Side of a block: the window moves by whole blocks, and leaves never cross their borders.
inline constexpr int block_side = 4;

/// Directions along the axes: +x, -x, +y, -y. d ^ 1 is opposite to d.
inline constexpr int directions = 4;
inline constexpr std::array<int, directions> step_i{1, -1, 0, 0}, step_j{0, 0, 1, -1};
/// The direction along x (axis 0) or y (1), to higher coordinates (toward 1) or lower ones (-1).
constexpr int direction(int axis, int toward) {
  return 2 * axis + (toward < 0);
}

/// Cells further apart are never linked: the largest distance that four bits hold.
inline constexpr int max_link_reach = 15;

/// Planes count as adjacent with at most this many cells between them: a face.
inline constexpr int widest_gap = 2;

}  // namespace curbline
