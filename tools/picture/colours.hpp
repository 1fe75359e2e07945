// Colours that people with any colour vision can tell apart.
#pragma once

#include <cstddef>

namespace curbline::tools::picture {

/// Red, green and blue in [0, 1].
struct Colour {
  double r, g, b;
};

inline constexpr Colour no_data{0.92, 0.92, 0.92};   ///< of a cell without points
inline constexpr Colour no_label{0.62, 0.62, 0.62};  ///< of a cell that belongs to no plane

/// Even steps of brightness from dark violet through green to yellow; share in [0, 1], clamped, 0 for NaN.
Colour height_colour(double share);

/// Of a plane, by how many are larger. The first seven are those of Okabe and Ito (2008) less black, which is for
/// lines; then seven that differ from them in brightness; then all again, paler.
Colour plane_colour(std::size_t rank);

}  // namespace curbline::tools::picture
