// Where a chain of borders (borders.hpp) turns a corner: where two lines follow it better than one. Cost: 60 operations
// a border.
#pragma once

#include "curbline/borders/borders.hpp"
#include "curbline/curbs/curb_piece.hpp"
#include "curbline/curbs/line_fit.hpp"
#include "curbline/limits.hpp"
#include "curbline/math.hpp"

namespace curbline {

/// The last border of the first of two lines, if two follow the borders better than one; else -1. Decided by evidence:
/// residuals, in half gaps, are normal with an unknown variance, whose prior weighs as four borders anywhere within
/// their gaps. All open borders together are one observation. A second line has two parameters and a place to begin,
/// each of which costs half the logarithm of the number of borders (Schwarz 1978). Two borders always lie on a line: it
/// takes three.
template <Limits limits>
int corner_of(const typename Borders<limits>::Part& part) {
  using Piece = CurbPiece<limits>;
  LineFit before, after;
  const auto weight = [&](const auto& border) { return border.weight() * part.share(border); };
  for (const auto& border : part) after.add(border.x_m, border.y_m, weight(border));
  const float one = after.squares(), n = part.observations();
  float two = one;
  int found = -1;
  for (int k = 0; k < part.size() - 3; ++k) {
    const auto& border = part[k];
    const float border_weight = weight(border);
    before.add(border.x_m, border.y_m, border_weight);
    after.remove(border.x_m, border.y_m, border_weight);
    if (k < 2) continue;
    const float squares = before.squares() + after.squares();
    if (squares >= two) continue;
    two = squares;
    found = k;
  }
  if (found < 0) return -1;
  const float gain =
      (Piece::place_a0 + 0.5f * n) * log((Piece::place_prior + one) / (Piece::place_prior + two)) - 1.5f * log(n);
  return gain > 0.0f ? found : -1;
}

}  // namespace curbline
