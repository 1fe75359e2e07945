// Colours that people with any colour vision can tell apart.
#pragma once

namespace curbline::tools {

struct Colour {
  double r, g, b;
};

/// Even steps of brightness from dark blue through green to yellow; share in [0, 1], clamped.
Colour height_colour(double share);

/// Of a plane: eight colours that differ in brightness too (Okabe and Ito 2008), then the same lighter and darker.
Colour label_colour(int label);

}  // namespace curbline::tools
