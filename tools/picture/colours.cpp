#include "picture/colours.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace curbline::tools {
namespace {

Colour mix(Colour a, Colour b, double t) { return {a.r + t * (b.r - a.r), a.g + t * (b.g - a.g), a.b + t * (b.b - a.b)}; }

}  // namespace

Colour height_colour(double share) {
  static constexpr std::array<Colour, 5> anchors{
      {{0.27, 0.00, 0.33}, {0.23, 0.32, 0.55}, {0.13, 0.57, 0.55}, {0.37, 0.79, 0.38}, {0.99, 0.91, 0.14}}};
  const double at = std::clamp(share, 0.0, 1.0) * (anchors.size() - 1);
  const auto n = std::min(static_cast<std::size_t>(at), anchors.size() - 2);
  return mix(anchors[n], anchors[n + 1], at - static_cast<double>(n));
}

Colour label_colour(int label) {
  static constexpr std::array<Colour, 8> base{{{0.34, 0.71, 0.91},
                                               {0.90, 0.62, 0.00},
                                               {0.00, 0.62, 0.45},
                                               {0.94, 0.89, 0.26},
                                               {0.80, 0.47, 0.65},
                                               {0.00, 0.45, 0.70},
                                               {0.84, 0.37, 0.00},
                                               {0.45, 0.45, 0.45}}};
  const Colour colour = base[static_cast<std::size_t>(label) % base.size()];
  const int turn = label / static_cast<int>(base.size()) % 3;
  return turn == 0 ? colour : turn == 1 ? mix(colour, {1, 1, 1}, 0.5) : mix(colour, {0, 0, 0}, 0.4);
}

}  // namespace curbline::tools
