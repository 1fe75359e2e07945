// Curbs: where two planes meet. Border points are found along every row and column of the window, chained into
// polylines by the pair of planes they part (borders.hpp), and cut into straight pieces. Each piece tells how much higher the far
// plane is. Cost: two passes over the window, 50 look-ups a border point, and the square of a chain's length for cutting it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "curbline/borders.hpp"
#include "curbline/counters.hpp"
#include "curbline/dem.hpp"
#include "curbline/label_field.hpp"
#include "curbline/line_fit.hpp"
#include "curbline/plane_mixture.hpp"
#include "curbline/settings.hpp"

namespace curbline {

enum class CurbKind : std::uint8_t {
  step_up,    ///< the far side is higher
  step_down,  ///< the far side is lower
  crease,     ///< planes of different slope that may meet at one height: a gutter, the edge of a ramp
};
const char* to_string(CurbKind kind);

/// A straight piece of curb line, in the map frame. Near is the side of the robot.
struct Curb {
  float x0_m = 0.0f, y0_m = 0.0f, x1_m = 0.0f, y1_m = 0.0f;
  float height_m = 0.0f;     ///< far plane less near plane, in the middle of the gap between them; above 0 is a step up; 0 of a crease
  float height_sd_m = 0.0f;  ///< from both planes' posteriors
  float probability = 0.0f;  ///< that the cells on both sides lie on different planes, mean along the piece
  CurbKind kind = CurbKind::crease;
  std::uint16_t near_label = 0, far_label = 0;
};

/// A border as it was drawn between two planes.
struct DrawnBorder {
  float height_m, height_sd_m;  ///< second plane less first there
  float half_gap_m;             ///< between the cells of the one and the other
  float reach_m;                ///< how far the planes' meeting may lie away
};

/// Planes of different slope make a crease where they meet. A border between them is one if they meet within reach of it and differ in
/// height there by no more than their slopes make up across half the gap, and what is not known (95 %) of the planes and of the cells
/// by which the border was drawn.
bool is_crease(const Plane& first, const Plane& second, const LineFit::Segment& border, const DrawnBorder& drawn);

template <Limits limits>
class CurbTracer {
 public:
  void init(const CurbSettings& settings) {
    settings_ = settings;
    curbs_ = 0;
  }

  /// Finds all curbs of the window, in working memory that is the caller's. (robot_x_m, robot_y_m): the robot in the window's frame.
  void trace(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const LabelField<limits>& field, float robot_x_m, float robot_y_m,
             Borders<limits>& borders, Counters& counters);

  /// What the last trace() found. Valid until the next.
  std::span<const Curb> curbs() const { return {curb_.data(), static_cast<std::size_t>(curbs_)}; }

 private:
  using LabelType = Label<limits>;
  static constexpr LabelType none = no_label<limits>;
  using Border = typename Borders<limits>::Border;

  /// A cell of a row or column and its plane.
  struct Place {
    LabelType label = none;
    std::int16_t along = 0;
  };

  int find_ground(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const LabelField<limits>& field);
  void find_borders(const Dem<limits>& dem, const LabelField<limits>& field, Borders<limits>& borders, Counters& counters) const;
  Border border_between(const Dem<limits>& dem, const LabelField<limits>& field, int axis, int across, const Place& a, const Place& b) const;
  void cut(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const Borders<limits>& borders, int length, Counters& counters);
  static int farthest_from_chord(const Borders<limits>& borders, int first, int last, float tolerance_m);
  void give_out(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const Borders<limits>& borders, int first, int last, Counters& counters);

  CurbSettings settings_{};
  float robot_x_m_ = 0.0f, robot_y_m_ = 0.0f;
  float reach_m_ = 0.0f;  ///< as far as gaps are bridged
  std::array<bool, limits.planes> ground_{};
  std::array<Curb, limits.curbs> curb_{};
  int curbs_ = 0;
};

template <Limits limits>
void CurbTracer<limits>::trace(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const LabelField<limits>& field, float robot_x_m,
                               float robot_y_m, Borders<limits>& borders, Counters& counters) {
  robot_x_m_ = robot_x_m;
  robot_y_m_ = robot_y_m;
  curbs_ = 0;
  reach_m_ = static_cast<float>(settings_.link_reach) * (dem.cell_x_m() < dem.cell_y_m() ? dem.cell_x_m() : dem.cell_y_m());
  if (find_ground(dem, mixture, field) < 2) return;
  borders.clear();
  find_borders(dem, field, borders, counters);
  for (int b = 0; b < borders.size(); ++b) {
    if (!borders.chained(b)) cut(dem, mixture, borders, borders.chain(dem, b, settings_.link_reach), counters);
  }
}

/// Which labels are planes of the ground. Not clutter: a label most of whose cells lie off its plane, so that its robust standard
/// deviation (1.4826 times the median residual) exceeds the bound. Not the face of a curb: a label whose runs are at most two
/// cells long on average along the rows or along the columns, as many as a vertical face can touch.
template <Limits limits>
int CurbTracer<limits>::find_ground(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const LabelField<limits>& field) {
  std::array<int, limits.planes> cells{}, off{}, row_runs{}, col_runs{};
  std::array<Place, limits.cols> last_in_col{};
  Place last_in_row;
  int row = -1;
  const auto starts_run = [&](Place& last, const Place& here) {
    const bool starts = last.label != here.label || here.along - last.along > settings_.link_reach;
    last = here;
    return starts;
  };
  const float bound = settings_.max_roughness_m / 1.4826f;
  dem.for_each_valid([&](int i, int j, int s) {
    const LabelType label = field.label(s);
    if (i != row) last_in_row = {};
    row = i;
    const bool starts_col = starts_run(last_in_col[static_cast<std::size_t>(j)], {label, static_cast<std::int16_t>(i)}), starts_row = starts_run(last_in_row, {label, static_cast<std::int16_t>(j)});
    if (label == none) return;
    const Cell& cell = dem.cell(s);
    const float residual = cell.height_m - mixture.plane(label).height_m(dem.centroid_x_m(i, cell), dem.centroid_y_m(j, cell));
    ++cells[label];
    off[label] += residual > bound || residual < -bound;
    row_runs[label] += starts_row;
    col_runs[label] += starts_col;
  });
  int ground = 0;
  for (std::size_t l = 0; l < ground_.size(); ++l) {
    ground_[l] = 2 * off[l] <= cells[l] && cells[l] > 2 * row_runs[l] && cells[l] > 2 * col_runs[l];
    ground += ground_[l];
  }
  return ground;
}

/// A border wherever the plane changes along a row or column. Cells that are not ground are looked through, as gaps are.
template <Limits limits>
void CurbTracer<limits>::find_borders(const Dem<limits>& dem, const LabelField<limits>& field, Borders<limits>& borders, Counters& counters) const {
  std::array<Place, limits.cols> before_in_col{};
  Place before_in_row;
  int row = -1;
  const auto pass = [&](Place& before, const Place& here, int axis, int across) {
    const bool border = before.label != none && before.label != here.label && here.along - before.along <= settings_.link_reach;
    if (border && !borders.add(dem, border_between(dem, field, axis, across, before, here))) ++counters.borders_full;
    before = here;
  };
  dem.for_each_valid([&](int i, int j, int s) {
    const LabelType label = field.label(s);
    if (label == none || !ground_[label]) return;
    if (i != row) before_in_row = {};
    row = i;
    pass(before_in_col[static_cast<std::size_t>(j)], {label, static_cast<std::int16_t>(i)}, 0, j);
    pass(before_in_row, {label, static_cast<std::int16_t>(j)}, 1, i);
  });
}

template <Limits limits>
auto CurbTracer<limits>::border_between(const Dem<limits>& dem, const LabelField<limits>& field, int axis, int across, const Place& a,
                                        const Place& b) const -> Border {
  const auto cell_belief = [&](int along) { return axis == 0 ? field.belief(dem, along, across) : field.belief(dem, across, along); };
  const auto p = cell_belief(a.along), q = cell_belief(b.along);
  float same = 0.0f;
  for (std::size_t m = 0; m < p.label.size(); ++m) {
    for (std::size_t n = 0; n < q.label.size(); ++n) {
      if (p.label[m] == q.label[n] && p.label[m] != none) same += p.probability[m] * q.probability[n];
    }
  }
  const float pitch = axis == 0 ? dem.cell_x_m() : dem.cell_y_m();
  const float middle = 0.5f * static_cast<float>(a.along + b.along + 1) * pitch;
  const float other = (static_cast<float>(across) + 0.5f) * (axis == 0 ? dem.cell_y_m() : dem.cell_x_m());
  const bool rising = a.label < b.label;
  return {axis == 0 ? middle : other,
          axis == 0 ? other : middle,
          1.0f - same,
          0.5f * static_cast<float>(b.along - a.along) * pitch,
          rising ? a.label : b.label,
          rising ? b.label : a.label,
          static_cast<std::int8_t>(axis),
          static_cast<std::int8_t>(rising ? 1 : -1),
          false,
          0};
}

/// Splits the chain where it leaves the chord by more than a cell (a straight line crossing cells stays within one) and
/// gives out the pieces in order.
template <Limits limits>
void CurbTracer<limits>::cut(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const Borders<limits>& borders, int length,
                             Counters& counters) {
  const float tolerance_m = dem.cell_x_m() > dem.cell_y_m() ? dem.cell_x_m() : dem.cell_y_m();
  int first = 0;
  do {
    int end = length - 1;
    for (int split = end; split >= 0; split = farthest_from_chord(borders, first, end, tolerance_m)) end = split;
    give_out(dem, mixture, borders, first, end, counters);
    first = end;
  } while (first < length - 1);
}

/// The border farthest from the chord between two others, -1 if none is farther than the tolerance.
template <Limits limits>
int CurbTracer<limits>::farthest_from_chord(const Borders<limits>& borders, int first, int last, float tolerance_m) {
  const Border& a = borders.at(first);
  const Border& b = borders.at(last);
  const float dx = b.x_m - a.x_m, dy = b.y_m - a.y_m;
  const float length2 = dx * dx + dy * dy;
  float worst = tolerance_m * tolerance_m;
  int found = -1;
  for (int k = first + 1; k < last; ++k) {
    const Border& p = borders.at(k);
    const float px = p.x_m - a.x_m, py = p.y_m - a.y_m;
    const float cross = dx * py - dy * px;
    // Of a closed chain the ends coincide: the distance from them counts.
    const float distance2 = length2 > 1e-6f ? cross * cross / length2 : px * px + py * py;
    if (distance2 > worst) {
      worst = distance2;
      found = k;
    }
  }
  return found;
}

template <Limits limits>
void CurbTracer<limits>::give_out(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const Borders<limits>& borders, int first, int last,
                                  Counters& counters) {
  if (curbs_ == limits.curbs) {
    ++counters.curbs_full;
    return;
  }
  const Border& a = borders.at(first);
  const Border& b = borders.at(last);
  const Plane& low = mixture.plane(a.low);
  const Plane& high = mixture.plane(a.high);
  LineFit fit;
  float height = 0.0f, variance = 0.0f, probability = 0.0f, half_gap = 0.0f, toward_x = 0.0f, toward_y = 0.0f;
  for (int k = first; k <= last; ++k) {
    const Border& border = borders.at(k);
    fit.add(border.x_m, border.y_m);
    height += high.height_m(border.x_m, border.y_m) - low.height_m(border.x_m, border.y_m);
    variance += high.height_variance_m2(border.x_m, border.y_m) + low.height_variance_m2(border.x_m, border.y_m);
    probability += border.probability;
    half_gap += border.half_gap_m;
    (border.axis == 0 ? toward_x : toward_y) += border.sign;
  }
  const float n = 1.0f / static_cast<float>(last - first + 1);
  const float half_cell_m = 0.25f * (dem.cell_x_m() + dem.cell_y_m());
  LineFit::Segment segment = fit.segment(a.x_m, a.y_m, b.x_m, b.y_m, half_cell_m);
  if (first == last) segment = LineFit::across(a.x_m, a.y_m, a.axis, half_cell_m);
  // `toward` points from the low-numbered plane to the other; the robot stands on the near side.
  const bool low_is_near = toward_x * (fit.x_m() - robot_x_m_) + toward_y * (fit.y_m() - robot_y_m_) >= 0.0f;
  Curb curb;
  curb.x0_m = dem.origin_x_m() + segment.x0_m;
  curb.y0_m = dem.origin_y_m() + segment.y0_m;
  curb.x1_m = dem.origin_x_m() + segment.x1_m;
  curb.y1_m = dem.origin_y_m() + segment.y1_m;
  curb.height_m = (low_is_near ? height : -height) * n;
  curb.height_sd_m = square_root(variance * n);  // the errors of a plane are common to the piece: they do not average out
  curb.probability = probability * n;
  curb.near_label = low_is_near ? a.low : a.high;
  curb.far_label = low_is_near ? a.high : a.low;
  if (is_crease(low, high, segment, {height * n, curb.height_sd_m, half_gap * n, reach_m_})) {
    curb.kind = CurbKind::crease;
    curb.height_m = 0.0f;
  } else {
    curb.kind = curb.height_m > 0.0f ? CurbKind::step_up : CurbKind::step_down;
  }
  if (curb.height_m > settings_.max_step_m || curb.height_m < -settings_.max_step_m) return;
  curb_[static_cast<std::size_t>(curbs_++)] = curb;
}

}  // namespace curbline
