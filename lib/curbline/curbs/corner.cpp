#include "curbline/curbs/corner.hpp"

#include "curbline/curbs/line_fit.hpp"
#include "curbline/math.hpp"

namespace curbline {

int corner_of(const ChainPart& part) {
  LineFit before, after;
  const auto weight = [&](const Border& border) { return border.weight() * part.share(border); };
  for (const Border& border : part) after.add(border.x_m, border.y_m, weight(border));
  const float one = after.squares(), n = part.observations();
  float two = one;
  int found = -1;
  for (int k = 0; k < part.size() - 3; ++k) {
    const Border& border = part[k];
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
      (ChainPart::place_a0 + 0.5f * n) * log((ChainPart::place_prior + one) / (ChainPart::place_prior + two)) -
      1.5f * log(n);
  return gain > 0.0f ? found : -1;
}

}  // namespace curbline
