// How much of their noise the points of a cell share, estimated from the map. Cells count as independent observations
// of their planes, but noise that points of a cell share is shared with the cells around too: ground is uneven over
// more than a cell, and errors of the tilt lie in stripes. A field whose neighbours along an axis correlate by r adds
// up as if each of its cells had (1 + r) / (1 - r) times its variance, along both axes by the product (Bartlett 1935,
// for a first-order autoregression). It is estimated in patches of 10 x 10 cells, each about a plane of its own, so
// that a step that does not divide planes yet affects only the patches that it crosses. Independent noise of a cell's
// points is included, the less the more there are. The uncertainty of the tilt's latency, which a single sweep does not
// show, is added. Errors of tilt and poses are those of whole scan lines, which run across the way ahead: what the
// cells of a row across it err alike is found by an analysis of variance (Fisher 1925). It averages out over the lines
// that see the row, so line_m2() is given for cells of one point: divide by the points of a cell.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/planes/plane_mixture.hpp"

namespace curbline {

/// Residuals of the cells of a patch: sums over cells at integer places (x, y).
struct PatchResiduals {
  static constexpr int side = 10;              ///< cells along x and along y
  static constexpr float least_cells = 20.0f;  ///< more than a row, so that their scatter is not singular

  float cells = 0.0f, x = 0.0f, y = 0.0f, xx = 0.0f, xy = 0.0f, yy = 0.0f;
  float off_m = 0.0f, x_off_m = 0.0f, y_off_m = 0.0f, squares_m2 = 0.0f;
  /// From a cell to its neighbour at the next higher x, or y.
  struct Rises {
    float pairs = 0.0f, sum_m = 0.0f, squares_m2 = 0.0f;
  };
  std::array<Rises, 2> rises{};
  /// The cells that lie equally far ahead: the same scan lines have seen them.
  struct Row {
    float cells = 0.0f, x = 0.0f, y = 0.0f, off_m = 0.0f;
  };
  static constexpr std::size_t most_rows = 2 * side;  ///< of very long cells, along the diagonal
  std::array<Row, most_rows> rows{};

  /// A cell above its plane. `ahead`: how many rows farther ahead the next cell along x (cos) and along y (sin) lies,
  /// together at most two.
  void add(float x_cells, float y_cells, float above_m, const SinCos& ahead);
  void add_rise(std::size_t axis, float rise_m) {
    rises[axis].pairs += 1.0f;
    rises[axis].sum_m += rise_m;
    rises[axis].squares_m2 += rise_m * rise_m;
  }
  struct Noise {
    float common_m2;  ///< variance that the points of a cell share: v (1 + r_x) / (1 - r_x) (1 + r_y) / (1 - r_y)
    float line_m2;    ///< of what the cells of a row err alike, beyond what each does; below 0 by chance
  };
  /// About the best plane of the patch. Needs at least least_cells.
  Noise noise() const;

 private:
  struct Fit {
    float level_m;     ///< at the origin
    float slope_m[2];  ///< a cell along x, along y
    float left_m2;     ///< mean square residual
  };
  Fit fit() const;
  float common_m2(const Fit& plane) const;
  float line_m2(const Fit& plane) const;
};

template <Limits limits>
class CommonNoise {
 public:
  void init() { *this = CommonNoise{}; }

  /// Examines the next row of patches; after the last, the first again. About 60 operations for each cell of these ten
  /// rows.
  void follow(const Dem<limits>& dem, const PlaneMixture<limits>& mixture);

  /// Variance that the points of a cell share: the lower quartile of the patches, weighted by cells, since curbs on
  /// both sides of a street and the end of a ramp may cross all others. Between PlanePrior::least_common_share and
  /// PlanePrior::common_share of the expected noise; the latter as long as there is no plane.
  float common_m2(const PlanePrior& prior, float latency_sd_s) const;
  /// Variance of what cells of one point in a row err alike, by a scan line's error in tilt and pose: PatchResiduals'
  /// times the points of a cell. Where these are many, uneven ground makes it large, so patches are weighted by cells
  /// over points, as in a ratio of sums. The median, as no curb is missed for it; 0 as long as there is no plane.
  float line_m2() const;

 private:
  static constexpr int side = PatchResiduals::side;
  static constexpr std::size_t patches_in_row = (limits.cols + side - 1) / side;
  static constexpr std::size_t patches = (limits.rows + side - 1) / side * patches_in_row;

  struct Seen {
    Label label = no_label;
    int i = -2;
    float above_m = 0.0f;
  };
  struct Patch {
    float cells = 0.0f;  ///< 0: too few
    PatchResiduals::Noise noise{};
    float points_a_cell = 1.0f;
    float growth_m2_s2 = 0.0f;  ///< sum of squares of Dem::growth_m_s()
  };
  /// Sums of a patch, while its cells are examined.
  struct PatchSums {
    PatchResiduals residuals{};
    float growth_m2_s2 = 0.0f, points = 0.0f;
  };
  struct PatchRow {
    SinCos ahead;  ///< rows_ahead()
    std::array<PatchSums, patches_in_row> patch{};
    std::array<Seen, limits.cols> last{};  ///< of each column
  };
  void look_at(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int i, int j, int slot,
               PatchRow& row) const;
  /// How many rows, each as long as a cell in the mean, a cell leads ahead.
  static SinCos rows_ahead(const Dem<limits>& dem) {
    const SinCos& ahead = dem.ahead_is();
    return {ahead.sin * (dem.cell_y_m() / dem.pitch_m()), ahead.cos * (dem.cell_x_m() / dem.pitch_m())};
  }
  /// The estimate of a patch, and its weight.
  struct Shown {
    float value, weight;
  };
  [[gnu::noinline]] static float quantile(std::array<Shown, patches>& left, float share);  ///< sets weights to 0

  std::array<Patch, patches> patches_{};
  int first_row_ = 0;  ///< of the next patches
};

template <Limits limits>
void CommonNoise<limits>::follow(const Dem<limits>& dem, const PlaneMixture<limits>& mixture) {
  PatchRow row{rows_ahead(dem)};
  for (int i = first_row_; i < first_row_ + side && i < dem.rows(); ++i) {
    dem.for_each_valid_in_row(i, [&](int, int j, int s) { look_at(dem, mixture, i, j, s, row); });
  }
  Patch* patch = &patches_[static_cast<std::size_t>(first_row_ / side) * patches_in_row];
  for (std::size_t k = 0; k < patches_in_row; ++k, ++patch) {
    *patch = Patch{};
    const PatchSums& sums = row.patch[k];
    const float cells = sums.residuals.cells;
    if (cells < PatchResiduals::least_cells) continue;
    *patch = {cells, sums.residuals.noise(), sums.points / cells, sums.growth_m2_s2};
  }
  first_row_ += side;
  if (first_row_ >= dem.rows()) first_row_ = 0;
}

/// Adds a cell that holds nothing but its plane, and its rise from the preceding neighbours.
template <Limits limits>
void CommonNoise<limits>::look_at(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int i, int j, int slot,
                                  PatchRow& row) const {
  const Label label = mixture.region_label(slot);
  if (label == no_label) return;
  const Plane& plane = mixture.plane(label);
  const Cell& cell = dem.cell(slot);
  if (dem.mixed(cell, dem.slope_m2(plane))) return;
  const Seen now{label, i, dem.above_m(i, j, cell, plane)};
  PatchSums& sums = row.patch[static_cast<std::size_t>(j / side)];
  sums.residuals.add(static_cast<float>(i - first_row_), static_cast<float>(j % side), now.above_m, row.ahead);
  sums.growth_m2_s2 += square(dem.growth_m_s(slot));
  sums.points += cell.points;
  const auto column = static_cast<std::size_t>(j);
  const auto rise_from = [&](const Seen& other, int other_i, std::size_t axis) {
    if (other.label == label && other.i == other_i) sums.residuals.add_rise(axis, now.above_m - other.above_m);
  };
  rise_from(row.last[column], i - 1, 0);
  if (j % side != 0) rise_from(row.last[column - 1], i, 1);
  row.last[column] = now;
}

template <Limits limits>
float CommonNoise<limits>::common_m2(const PlanePrior& prior, float latency_sd_s) const {
  std::array<Shown, patches> shown;
  float cells = 0.0f, growth_m2_s2 = 0.0f;
  for (std::size_t k = 0; k < patches; ++k) {
    shown[k] = {patches_[k].noise.common_m2, patches_[k].cells};
    cells += patches_[k].cells;
    growth_m2_s2 += patches_[k].growth_m2_s2;
  }
  if (!(cells > 0.0f)) return prior.common_m2();
  const float common_m2 = quantile(shown, 0.25f) + latency_sd_s * latency_sd_s * growth_m2_s2 / cells;
  const float least_m2 = PlanePrior::least_common_share * prior.noise_m2, most_m2 = prior.common_m2();
  return common_m2 < least_m2 ? least_m2 : common_m2 < most_m2 ? common_m2 : most_m2;
}

template <Limits limits>
float CommonNoise<limits>::line_m2() const {
  std::array<Shown, patches> shown;
  for (std::size_t k = 0; k < patches; ++k) {
    const float points = patches_[k].points_a_cell;
    shown[k] = {patches_[k].noise.line_m2 * points, patches_[k].cells / points};
  }
  return std::max(0.0f, quantile(shown, 0.5f));
}

/// Weighted quantile; 0 if there is no weight.
template <Limits limits>
float CommonNoise<limits>::quantile(std::array<Shown, patches>& left, float share) {
  float all = 0.0f, found = 0.0f;
  for (const Shown& shown : left) all += shown.weight;
  for (float passed = 0.0f; passed < share * all;) {  // in ascending order, each once
    Shown* least = nullptr;
    for (Shown& shown : left) {
      if (shown.weight > 0.0f && (least == nullptr || shown.value < least->value)) least = &shown;
    }
    found = least->value;
    passed += least->weight;
    least->weight = 0.0f;
  }
  return found;
}

}  // namespace curbline
