// Where a chain of borders (borders.hpp) turns a corner: where two lines follow it better than one. Cost: 60 operations
// a border.
#pragma once

#include "curbline/borders/border.hpp"

namespace curbline {

/// The last border of the first of two lines, if two follow the borders better than one; else -1. Decided by evidence:
/// residuals, in half gaps, are normal with an unknown variance, whose prior weighs as four borders anywhere within
/// their gaps. All open borders together are one observation. A second line has two parameters and a place to begin,
/// each of which costs half the logarithm of the number of borders (Schwarz 1978). Two borders always lie on a line: it
/// takes three.
int corner_of(const ChainPart& part);

}  // namespace curbline
