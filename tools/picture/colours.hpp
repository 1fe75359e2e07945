// Colours that can be distinguished with any colour vision.
#pragma once

#include <cstddef>

namespace curbline::tools::picture {

/// Red, green and blue in [0, 1].
struct Colour {
  double r, g, b;
};

inline constexpr Colour no_data{0.92, 0.92, 0.92};   ///< a cell without points
inline constexpr Colour no_label{0.62, 0.62, 0.62};  ///< a cell that belongs to no plane

/// Uniform steps of brightness from dark violet through green to yellow; share in [0, 1], clamped, 0 for NaN.
Colour height_colour(double share);

/// The colour of a plane, by the number of larger planes. The first seven are those of Okabe and Ito (2008) without
/// black, which is used for lines; then seven that differ from them in brightness; then all again, paler.
Colour plane_colour(std::size_t rank);

}  // namespace curbline::tools::picture
