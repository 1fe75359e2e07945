// Which planes follow one bent surface (bend.hpp). Planes stay as they are, so that the height of a curb is that of the
// ground beside it; a surface is a name that they share, and no crease is reported between its planes. Cost: a pass
// over a quarter of the window where planes meet at a crease, 120 operations a crease, and one for each curb.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "curbline/borders/curb_stages.hpp"
#include "curbline/curbs/bend.hpp"
#include "curbline/curbs/curb.hpp"
#include "curbline/grid.hpp"
#include "curbline/limits.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/plane.hpp"

namespace curbline {

template <Limits limits>
class Surfaces {
 public:
  void init() {
    for (std::size_t l = 0; l < limits.planes; ++l) name_[l] = static_cast<Label>(l);
  }

  /// The lowest label among the planes of its surface; its own if it shares none.
  Label name(Label plane) const { return plane == no_label ? no_label : name_[plane]; }

  /// Working memory of one follow(), by label.
  using Work = std::array<BendSums, limits.planes>;

  /// Names all planes anew. Two that meet at a crease, of a ramp or not, are one surface if their cells are likelier to
  /// follow its bend than to lie flat, by three standard deviations, unless most of their border is a step.
  // Cold, as are its callees: compiled for size, to fit the flash budget.
  [[gnu::cold]] void follow(const CurbStages<limits>& stages, Work& work, std::span<const Curb> curbs);

  /// Is it a crease between planes of one surface?
  bool hold(const Curb& curb) const { return is_crease(curb) && name_[curb.near_label] == name_[curb.far_label]; }

 private:
  static constexpr int rows_apart = 4;  ///< between rows whose cells are used: neighbours err alike

  static bool is_crease(const Curb& curb) { return !is_step(curb) && curb.far_label != no_label; }
  [[gnu::cold]] static void look_at(const CurbStages<limits>& stages, Work& work);
  static bool step_between(std::span<const Curb> curbs, const Curb& crease);

  std::array<Label, limits.planes> name_{};
};

template <Limits limits>
void Surfaces<limits>::follow(const CurbStages<limits>& stages, Work& work, std::span<const Curb> curbs) {
  init();
  bool looked = false;
  for (const Curb& curb : curbs) {
    if (!is_crease(curb)) continue;
    if (!looked) look_at(stages, work);
    looked = true;
    const Label one = curb.near_label, other = curb.far_label;
    if (!one_bend(stages.mixture.plane(one), work[one], stages.mixture.plane(other), work[other])) continue;
    if (step_between(curbs, curb)) continue;
    const Label near = name_[one], far = name_[other];
    std::replace(name_.begin(), name_.end(), std::max(near, far), std::min(near, far));
  }
}

/// Sums over cells that hold their plane alone: anything else in them would pass for a bend.
template <Limits limits>
void Surfaces<limits>::look_at(const CurbStages<limits>& stages, Work& work) {
  const Dem<limits>& dem = stages.dem;
  work.fill({});
  for (int i = 0; i < dem.rows(); i += rows_apart) {
    dem.for_each_valid_in_row(i, [&](int, int j, int s) {
      const Label label = stages.field.label(s);
      if (label == no_label) return;
      const Plane& plane = stages.mixture.plane(label);
      const Cell& cell = dem.cell(s);
      if (!stages.holds_alone(s, label, dem.slope_m2(plane))) return;
      work[label].add(dem.centroid_x_m(i, cell) - plane.x_m, dem.centroid_y_m(j, cell) - plane.y_m,
                      dem.above_m(i, j, cell, plane));
    });
  }
}

/// Are the steps between the planes of a crease longer than its creases? Planes cross where a curb runs out.
template <Limits limits>
bool Surfaces<limits>::step_between(std::span<const Curb> curbs, const Curb& crease) {
  float steps_m = 0.0f;  // less creases
  for (const Curb& curb : curbs) {
    const bool along = curb.near_label == crease.near_label && curb.far_label == crease.far_label;
    const bool against = curb.near_label == crease.far_label && curb.far_label == crease.near_label;
    if (along || against) steps_m += is_step(curb) ? length_of(curb) : -length_of(curb);
  }
  return steps_m > 0.0f;
}

}  // namespace curbline
