// A map small enough to follow by eye, with every stage that works on it, for tests of one stage behind the others.
#pragma once

#include <memory>

#include "curbline/curbs/crossed_cells.hpp"
#include "curbline/curbs/curb_tracer.hpp"
#include "curbline/labels/label_field.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/planes/plane_mixture.hpp"
#include "curbline/regions/segmentation.hpp"
#include "curbline/sweeps.hpp"
#include "curbline/workspace.hpp"
#include "support/terrain.hpp"

namespace curbline::test {

inline constexpr Limits small_limits{.rows = 24, .cols = 24, .planes = 6, .beams = 181};

/// A fixed window with its lowest corner at the origin and cells of 0.1 m.
inline Settings small_settings(int rows = 24, int cols = 24) {
  Settings settings;
  settings.window = {.rows = rows, .cols = cols, .origin_x_m = 0.0f, .origin_y_m = 0.0f, .fixed = true};
  settings.labels.max_messages = 4 * rows * cols;  // a single update() reaches every cell
  return settings;
}

/// Gives each cell of a window four points around its centre at height_m(x, y) +- spread, so that all cells have the
/// same variance.
template <Limits limits, typename Height>
void fill(Dem<limits>& dem, Height&& height_m, double spread_m = 0.002) {
  const double dx = dem.cell_x_m(), dy = dem.cell_y_m();
  for (int i = 0; i < dem.rows(); ++i) {
    for (int j = 0; j < dem.cols(); ++j) {
      for (int k = 0; k < 4; ++k) {
        const double x = dem.origin_x_m() + (i + (k % 2 == 0 ? 0.3 : 0.7)) * dx,
                     y = dem.origin_y_m() + (j + (k / 2 == 0 ? 0.3 : 0.7)) * dy;
        const double z = height_m(x, y) + (k == 0 || k == 3 ? spread_m : -spread_m);
        dem.add({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), 1e-4f});
      }
    }
  }
}

/// The stages from cells to curbs, as in Pipeline, each accessible to the test.
template <Limits limits = small_limits>
struct Stages {
  explicit Stages(const Settings& s) {
    dem.init(s.window, s.planes.prior);
    segmentation.init(s.segmentation, s.planes.prior);
    mixture.init(s.planes);
    field.init(s.labels);
    tracer.init(s.curbs);
  }
  void segment() {
    segmented = &work.segmentation();
    segmentation.update(
        dem, *segmented, mixture.largest_ground(), [this](int slot) { return mixture.obstructed(dem, slot); },
        counters);
  }
  /// Its changes can be queried until the next call.
  void mix() {
    mixture.forget_changes();
    mixture.update(
        dem, *segmented, view, crossed_cells(dem, tracer.curbs()), [this](int slot) { return field.label(slot); },
        counters);
  }
  int label(bool all = true) {
    field.note_touched(dem);
    const int changed =
        field.update(dem, mixture, all ? FieldScope::window : FieldScope::line, work.visits(), counters);
    dem.clear_touched();
    return changed;
  }
  /// One call of each stage, as for a scan line.
  void infer(bool all = false) {
    segment();
    mix();
    label(all);
  }
  /// As many passes as the labels of such a map need to settle.
  void settle() {
    for (int pass = 0; pass < 3; ++pass) infer(true);
  }
  void trace(float robot_x_m = 0.0f, float robot_y_m = 0.0f) {
    Viewpoint from = view;
    from.x_m = robot_x_m;
    from.y_m = robot_y_m;
    tracer.trace(dem, mixture, field, from, latency, work.curbs(), counters);
  }
  auto region_at(int i, int j) const { return segmentation.region(dem.slot(i, j)); }
  auto label_at(int i, int j) const { return field.label(dem.slot(i, j)); }

  Viewpoint view{0.0f, 0.0f, 1.0f};
  LatencyDoubt latency{};  ///< none
  Counters counters{};
  Workspace<limits> work{};
  typename Segmentation<limits>::Work* segmented = nullptr;  ///< valid until label()
  Dem<limits> dem{};
  Segmentation<limits> segmentation{};
  PlaneMixture<limits> mixture{};
  LabelField<limits> field{};
  CurbTracer<limits> tracer{};
};

}  // namespace curbline::test
