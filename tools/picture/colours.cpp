#include "picture/colours.hpp"

#include <algorithm>
#include <array>

namespace curbline::tools::picture {
namespace {

Colour mix(Colour a, Colour b, double t) {
  return {a.r + t * (b.r - a.r), a.g + t * (b.g - a.g), a.b + t * (b.b - a.b)};
}

}  // namespace

Colour height_colour(double share) {
  static constexpr std::array<Colour, 7> anchors{{{0.27, 0.00, 0.33},
                                                  {0.27, 0.23, 0.51},
                                                  {0.19, 0.41, 0.56},
                                                  {0.13, 0.57, 0.55},
                                                  {0.21, 0.72, 0.47},
                                                  {0.56, 0.84, 0.27},
                                                  {0.99, 0.91, 0.14}}};
  const double at = (share > 0 ? std::min(share, 1.0) : 0.0) * (anchors.size() - 1);
  const auto n = std::min(static_cast<std::size_t>(at), anchors.size() - 2);
  return mix(anchors[n], anchors[n + 1], at - static_cast<double>(n));
}

Colour plane_colour(std::size_t rank) {
  static constexpr std::array<Colour, 14> colours{{{0.34, 0.71, 0.91},
                                                   {0.90, 0.62, 0.00},
                                                   {0.00, 0.62, 0.45},
                                                   {0.94, 0.89, 0.26},
                                                   {0.80, 0.47, 0.65},
                                                   {0.00, 0.45, 0.70},
                                                   {0.84, 0.37, 0.00},
                                                   {0.80, 0.86, 0.60},
                                                   {0.30, 0.20, 0.50},
                                                   {0.98, 0.74, 0.68},
                                                   {0.45, 0.28, 0.12},
                                                   {0.70, 0.90, 0.88},
                                                   {0.50, 0.12, 0.30},
                                                   {0.12, 0.32, 0.18}}};
  const bool again = rank / colours.size() % 2 == 1;
  return mix(colours[rank % colours.size()], {1, 1, 1}, again ? 0.45 : 0.0);
}

}  // namespace curbline::tools::picture
