// How much of their noise the points of a cell share, found from the map. Cells count as independent observations of
// their planes, but what their points share they share with the cells around too: ground is uneven over more than one
// cell, and errors of the tilt lie in stripes. A field whose neighbours along an axis correlate by r adds up as if each
// of its cells had (1 + r) / (1 - r) times its variance, along both axes by their product (Bartlett 1935, of a
// first-order autoregression). What the points of a cell err each on its own is counted too, the less the more there
// are. What is not known of the tilt's latency moves a whole sweep: the cells of a single one do not show it, and it is
// added. Cost: a pass over the window, about 25 operations a cell.
#pragma once

#include <array>
#include <cstddef>

#include "curbline/dem.hpp"
#include "curbline/plane_mixture.hpp"

namespace curbline {

template <Limits limits>
class CommonNoise {
 public:
  /// Share of the expected noise, no less than the ground's texture makes and no more than PlanePrior::common_share,
  /// which it is too as long as there is no plane: of the planes, each weighed by its cells, the one in the middle.
  static float share(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const PlanePrior& prior,
                     float latency_sd_s) {
    return CommonNoise(dem, mixture).middle(prior, latency_sd_s);
  }

 private:
  CommonNoise(const Dem<limits>& dem, const PlaneMixture<limits>& mixture);
  float middle(const PlanePrior& prior, float latency_sd_s);

  using LabelType = Label<limits>;

  /// Of the cells of a plane that hold nothing else: how far they lie off it.
  struct Residuals {
    float cells = 0.0f, squares_m2 = 0.0f;
    float growth_m2_s2 = 0.0f;                    ///< by latency, its squares
    std::array<float, 2> pairs{}, products_m2{};  ///< of neighbours along x, y

    float common_m2(float latency_sd_s) const {
      const float by_latency_m2 = latency_sd_s * latency_sd_s * growth_m2_s2 / cells;
      const float mean_m2 = squares_m2 / cells;
      return mean_m2 > 0.0f ? mean_m2 * alike(0, mean_m2) * alike(1, mean_m2) + by_latency_m2 : by_latency_m2;
    }

   private:
    float alike(std::size_t axis, float mean_m2) const {
      if (!(products_m2[axis] > 0.0f)) return 1.0f;
      constexpr float most = 0.95f;  // 20 cells far: half a window
      const float r = products_m2[axis] / (pairs[axis] * mean_m2);
      return r < most ? (1.0f + r) / (1.0f - r) : (1.0f + most) / (1.0f - most);
    }
  };
  struct Seen {
    LabelType label = PlaneMixture<limits>::none;
    int i = -2, j = -2;
    float above_m = 0.0f;
  };

  std::array<Residuals, limits.planes> of_plane_{};
};

template <Limits limits>
CommonNoise<limits>::CommonNoise(const Dem<limits>& dem, const PlaneMixture<limits>& mixture) {
  std::array<Seen, limits.cols> row_before{};
  Seen before{};
  dem.for_each_valid([&](int i, int j, int s) {
    const LabelType label = mixture.region_label(s);
    if (label == PlaneMixture<limits>::none) return;
    const Plane& plane = mixture.plane(label);
    const Cell& cell = dem.cell(s);
    if (dem.mixed(cell, plane)) return;
    const Seen now{label, i, j, dem.above_m(i, j, cell, plane)};
    Residuals& residuals = of_plane_[label];
    const auto pair = [&](std::size_t axis, const Seen& other) {
      residuals.pairs[axis] += 1.0f;
      residuals.products_m2[axis] += now.above_m * other.above_m;
    };
    residuals.cells += 1.0f;
    residuals.squares_m2 += now.above_m * now.above_m;
    residuals.growth_m2_s2 += dem.growth_m_s(s) * dem.growth_m_s(s);
    Seen& below = row_before[static_cast<std::size_t>(j)];
    if (below.label == label && below.i == i - 1) pair(0, below);
    if (before.label == label && before.i == i && before.j == j - 1) pair(1, before);
    before = below = now;
  });
}

template <Limits limits>
float CommonNoise<limits>::middle(const PlanePrior& prior, float latency_sd_s) {
  float cells = 0.0f;
  for (const Residuals& plane : of_plane_) cells += plane.cells;
  if (!(cells > 0.0f)) return prior.common_share;
  float common_m2 = 0.0f;
  for (float passed = 0.0f; 2.0f * passed < cells;) {  // the least first, each once
    Residuals* least = nullptr;
    for (Residuals& plane : of_plane_) {
      if (!(plane.cells > 0.0f)) continue;
      const float plane_m2 = plane.common_m2(latency_sd_s);
      if (least != nullptr && plane_m2 >= common_m2) continue;
      least = &plane;
      common_m2 = plane_m2;
    }
    passed += least->cells;
    least->cells = 0.0f;
  }
  float share = (common_m2 > prior.texture_m2 ? common_m2 : prior.texture_m2) / prior.noise_m2;
  if (share < PlanePrior::least_common_share) share = PlanePrior::least_common_share;
  return share < prior.common_share ? share : prior.common_share;
}

}  // namespace curbline
