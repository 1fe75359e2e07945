// Which planes are ground. A region may fit a plane and be none that a wheel could stand on:
//   - a face: a strip between two others, of a height between theirs, that no cell shows alone. The heights within its
//     cells spread over most of the step: it is narrower than a cell and a half, and its plane is what mixing both
//     sides makes.
//   - an obstacle: a region within whose cells the heights spread as on a slope of more than 45 degrees;
//   - a veil: readings that mix an obstacle's edge and what lies behind it, which all lie on the rays between. Its
//   plane
//     holds the laser itself, and no surface that does is seen.
// No cell bears such a plane; its cells are left to the ground beside them, and curbs look through them. Cost: three
// passes over the window.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "curbline/dem.hpp"
#include "curbline/plane.hpp"
#include "curbline/point.hpp"

namespace curbline {

template <Limits limits>
class Ground {
 public:
  void clear() { ground_.fill(true); }

  /// Asks each plane anew. label_of(slot) is the plane of a valid cell's region, `none` if it has none; changed(label)
  /// is called for each answer that is another than before.
  template <typename LabelType, typename LabelOf, typename Changed>
  void update(const Dem<limits>& dem, std::span<const Plane> planes, const Viewpoint& view, LabelType none,
              LabelOf&& label_of, Changed&& changed);

  bool is(int label) const { return ground_[static_cast<std::size_t>(label)]; }

 private:
  /// In cells: as many as a face of one and a half touches when it lies across the grid.
  static constexpr int longest_strip = 3;
  static constexpr int widest_gap = 2;           ///< between a strip and the planes beside it, in cells
  static constexpr float narrow = 1.5f;          ///< cells: a wider strip has cells of its own
  static constexpr float lowest_laser_m = 0.3f;  ///< above the ground: no kerb or stair is as high

  /// What is known of a plane's cells, and of those of its runs that are strips between other planes.
  struct Tally {
    float cells = 0.0f, spread_m2 = 0.0f, weight = 0.0f;  ///< spread: scatter beyond the noise of the points
    float strip_cells = 0.0f, strips = 0.0f, step_m = 0.0f, strip_scatter_m2 = 0.0f, strip_weight = 0.0f;

    bool face() const {
      const float mean_step_m = step_m / (strips > 0.0f ? strips : 1.0f);
      // Heights that are spread evenly over a width of w cells have a standard deviation of step / (w sqrt(12)) within
      // each.
      return cells > 0.0f && 2.0f * strip_cells >= cells &&
             mean_step_m * mean_step_m * strip_weight <= narrow * narrow * 12.0f * strip_scatter_m2;
    }
    bool obstacle(float cell_area_m2) const { return spread_m2 > cell_area_m2 * (1.0f / 12) * weight; }
  };
  /// Cells of one plane that follow each other on a row or column.
  template <typename LabelType>
  struct Run {
    LabelType label;
    int first, last;
    float first_height_m, last_height_m, lowest_m, highest_m;
    float scatter_m2, weight;

    /// Does a step from `before` to `next` lead over it?
    bool between(const Run& before, const Run& next) const {
      const float from = before.last_height_m, to = next.first_height_m;
      return last - first < longest_strip && first - before.last <= widest_gap && next.first - last <= widest_gap &&
             ((from < lowest_m && highest_m < to) || (from > highest_m && lowest_m > to));
    }
  };

  /// Within three standard deviations.
  static bool holds(const Plane& plane, const Viewpoint& view) {
    const float above_m = view.z_m - plane.height_m(view.x_m, view.y_m);
    return above_m * above_m <= 9.0f * (plane.variance_m2 + plane.height_variance_m2(view.x_m, view.y_m));
  }
  static bool any_veils(std::span<const Plane> planes, const Viewpoint& view);

  std::array<bool, limits.planes> ground_{};
};

/// Only seen from well above the largest plane. Else the viewpoint is not where the points were seen from, as of a
/// cloud whose origin lies on the ground, and a plane that holds it may be a pavement.
template <Limits limits>
bool Ground<limits>::any_veils(std::span<const Plane> planes, const Viewpoint& view) {
  const Plane* largest = nullptr;
  for (const Plane& plane : planes) {
    if (plane.alive() && (largest == nullptr || plane.cells > largest->cells)) largest = &plane;
  }
  return largest != nullptr && view.z_m - largest->height_m(view.x_m, view.y_m) > lowest_laser_m;
}

template <Limits limits>
template <typename LabelType, typename LabelOf, typename Changed>
void Ground<limits>::update(const Dem<limits>& dem, std::span<const Plane> planes, const Viewpoint& view,
                            LabelType none, LabelOf&& label_of, Changed&& changed) {
  std::array<Tally, limits.planes> tallies{};
  const auto end_run = [&](const Run<LabelType>& before, const Run<LabelType>& run, const Run<LabelType>& next) {
    if (run.label == none || before.label == none || next.label == none || !run.between(before, next)) return;
    Tally& tally = tallies[run.label];
    const float step_m = next.first_height_m - before.last_height_m;
    tally.strips += 1.0f;
    tally.strip_cells += static_cast<float>(run.last - run.first + 1);
    tally.step_m += step_m < 0.0f ? -step_m : step_m;
    tally.strip_scatter_m2 += run.scatter_m2;
    tally.strip_weight += run.weight;
  };
  const auto walk = [&](int lines, int length, auto&& slot_of) {
    const Run<LabelType> nothing{none, 0, 0, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f};
    for (int line = 0; line < lines; ++line) {
      Run<LabelType> before = nothing, run = nothing;
      for (int k = 0; k < length; ++k) {
        const int s = slot_of(line, k);
        const Cell& cell = dem.cell(s);
        const LabelType label = cell.valid() ? label_of(s) : none;
        if (label == none) continue;
        const float h = cell.height_m;
        if (label != run.label) {
          const Run<LabelType> next{label, k, k, h, h, h, h, cell.scatter_m2, cell.weight};
          end_run(before, run, next);
          before = run;
          run = next;
          continue;
        }
        run.last = k;
        run.last_height_m = h;
        if (h < run.lowest_m) run.lowest_m = h;
        if (h > run.highest_m) run.highest_m = h;
        run.scatter_m2 += cell.scatter_m2;
        run.weight += cell.weight;
      }
      end_run(before, run, nothing);
    }
  };
  walk(dem.rows(), dem.cols(), [&](int i, int j) { return dem.slot(i, j); });
  walk(dem.cols(), dem.rows(), [&](int j, int i) { return dem.slot(i, j); });
  dem.for_each_valid([&](int, int, int s) {
    const LabelType label = label_of(s);
    if (label == none) return;
    Tally& tally = tallies[label];
    tally.cells += 1.0f;
    tally.spread_m2 += dem.spread_m2(dem.cell(s));
    tally.weight += dem.cell(s).weight;
  });
  const float cell_area_m2 = dem.cell_x_m() * dem.cell_y_m();
  const bool veils = any_veils(planes, view);
  for (std::size_t l = 0; l < ground_.size(); ++l) {
    const bool veil = veils && planes[l].alive() && holds(planes[l], view);
    const bool ground = !tallies[l].face() && !tallies[l].obstacle(cell_area_m2) && !veil;
    if (ground != ground_[l]) changed(static_cast<LabelType>(l));
    ground_[l] = ground;
  }
}

}  // namespace curbline
