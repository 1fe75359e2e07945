// Curbs: where two planes meet. Border points are found along every row and column of the window, chained into
// polylines by the pair of planes they part, and cut into straight pieces. Each piece tells how much higher the far
// plane is. Cost: two passes over the window, 50 look-ups a border point, and the square of a chain's length for cutting it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

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
  float height_m = 0.0f;     ///< far plane less near plane, in the middle of the gap between them; above 0 is a step up
  float height_sd_m = 0.0f;  ///< from both planes' posteriors
  float probability = 0.0f;  ///< that the cells on both sides lie on different planes, mean along the piece
  CurbKind kind = CurbKind::crease;
  std::uint16_t near_label = 0, far_label = 0;
};

template <Limits limits>
class CurbTracer {
 public:
  void init(const CurbSettings& settings) {
    settings_ = settings;
    curbs_ = 0;
  }

  /// Finds all curbs of the window. (robot_x_m, robot_y_m): the robot in the window's frame.
  void trace(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const LabelField<limits>& field, float robot_x_m, float robot_y_m,
             Counters& counters);

  /// What the last trace() found. Valid until the next.
  std::span<const Curb> curbs() const { return {curb_.data(), static_cast<std::size_t>(curbs_)}; }

 private:
  using LabelType = Label<limits>;
  static constexpr LabelType none = no_label<limits>;
  static constexpr std::uint16_t no_border = 0xFFFF;

  /// Middle of the gap between two planes on a row or column, in the window's frame.
  struct Border {
    float x_m, y_m;
    float probability;
    float half_gap_m;
    LabelType low, high;         ///< the planes, low < high by number
    std::int8_t axis;            ///< 0: found along x, 1: along y
    std::int8_t sign;            ///< +1 if `high` lies in the positive direction of the axis
    std::uint16_t next_in_cell;  ///< another border in the same cell
    bool chained;
  };
  /// A cell of a row or column and its plane.
  struct Place {
    LabelType label = none;
    int along = 0;
  };

  void find_ground(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const LabelField<limits>& field);
  void scan(const Dem<limits>& dem, const LabelField<limits>& field, int axis, int across, Counters& counters);
  void add_border(const Dem<limits>& dem, const LabelField<limits>& field, int axis, int across, const Place& a, const Place& b, Counters& counters);
  std::uint16_t nearest(const Dem<limits>& dem, const Border& from) const;
  std::uint16_t nearest_within(const Dem<limits>& dem, const Border& from, int reach) const;
  int chain(const Dem<limits>& dem, std::uint16_t start);
  void cut(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int first, int last, Counters& counters);
  int farthest_from_chord(int first, int last, float tolerance_m) const;
  void give_out(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int first, int last, Counters& counters);
  int cell_of(const Dem<limits>& dem, const Border& border) const {
    return dem.slot(static_cast<int>(border.x_m / dem.cell_x_m()), static_cast<int>(border.y_m / dem.cell_y_m()));
  }

  CurbSettings settings_{};
  float robot_x_m_ = 0.0f, robot_y_m_ = 0.0f;
  std::array<bool, limits.planes> ground_{};
  std::array<Border, limits.borders> border_{};
  int borders_ = 0;
  std::array<std::uint16_t, Dem<limits>::capacity> border_in_cell_{};
  std::array<std::uint16_t, limits.borders> chain_{};  ///< of the polyline in hand, in order
  std::array<Curb, limits.curbs> curb_{};
  int curbs_ = 0;
};

template <Limits limits>
void CurbTracer<limits>::trace(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const LabelField<limits>& field, float robot_x_m,
                               float robot_y_m, Counters& counters) {
  robot_x_m_ = robot_x_m;
  robot_y_m_ = robot_y_m;
  borders_ = curbs_ = 0;
  border_in_cell_.fill(no_border);
  find_ground(dem, mixture, field);
  for (int j = 0; j < dem.cols(); ++j) scan(dem, field, 0, j, counters);
  for (int i = 0; i < dem.rows(); ++i) scan(dem, field, 1, i, counters);
  for (int b = 0; b < borders_; ++b) {
    if (border_[static_cast<std::size_t>(b)].chained) continue;
    // Walk to an end of the polyline, then chain it from there.
    const int walked = chain(dem, static_cast<std::uint16_t>(b));
    for (int k = 0; k < walked; ++k) border_[chain_[static_cast<std::size_t>(k)]].chained = false;
    const int length = chain(dem, chain_[static_cast<std::size_t>(walked - 1)]);
    cut(dem, mixture, 0, length - 1, counters);
  }
}

/// Which labels are planes of the ground. Not clutter: a label most of whose cells lie off its plane, so that its robust standard
/// deviation (1.4826 times the median residual) exceeds the bound. Not the face of a curb: a label whose runs are at most two
/// cells long on average along the rows or along the columns, as many as a vertical face can touch.
template <Limits limits>
void CurbTracer<limits>::find_ground(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const LabelField<limits>& field) {
  std::array<int, limits.planes> cells{}, off{}, row_runs{}, col_runs{};
  const float bound = settings_.max_roughness_m / 1.4826f;
  const auto starts_run = [&](int i, int j, int di, int dj, LabelType label) {
    const int g = dem.next_valid(i, j, -di, -dj, settings_.link_reach);
    return g == 0 || field.label(dem.slot(i - g * di, j - g * dj)) != label;
  };
  for (int i = 0; i < dem.rows(); ++i) {
    for (int j = 0; j < dem.cols(); ++j) {
      const int s = dem.slot(i, j);
      const Cell& cell = dem.cell(s);
      const LabelType label = field.label(s);
      if (!cell.valid() || label == none) continue;
      const float residual = cell.height_m - mixture.plane(label).height_m(dem.centroid_x_m(i, cell), dem.centroid_y_m(j, cell));
      ++cells[label];
      off[label] += residual > bound || residual < -bound;
      row_runs[label] += starts_run(i, j, 1, 0, label);
      col_runs[label] += starts_run(i, j, 0, 1, label);
    }
  }
  for (std::size_t l = 0; l < ground_.size(); ++l) {
    ground_[l] = 2 * off[l] <= cells[l] && cells[l] > 2 * row_runs[l] && cells[l] > 2 * col_runs[l];
  }
}

/// One row (axis 0) or column: a border wherever the plane changes. Cells that are not ground are looked through, as gaps are.
template <Limits limits>
void CurbTracer<limits>::scan(const Dem<limits>& dem, const LabelField<limits>& field, int axis, int across, Counters& counters) {
  const int length = axis == 0 ? dem.rows() : dem.cols();
  Place before;
  for (int along = 0; along < length; ++along) {
    const int s = axis == 0 ? dem.slot(along, across) : dem.slot(across, along);
    const LabelType label = dem.cell(s).valid() ? field.label(s) : none;
    if (label == none || !ground_[label]) continue;
    const Place here{label, along};
    if (before.label != none && before.label != label && along - before.along <= settings_.link_reach) {
      add_border(dem, field, axis, across, before, here, counters);
    }
    before = here;
  }
}

template <Limits limits>
void CurbTracer<limits>::add_border(const Dem<limits>& dem, const LabelField<limits>& field, int axis, int across, const Place& a, const Place& b,
                                    Counters& counters) {
  if (borders_ == limits.borders) {
    ++counters.borders_full;
    return;
  }
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
  Border border{axis == 0 ? middle : other, axis == 0 ? other : middle, 1.0f - same, 0.5f * static_cast<float>(b.along - a.along) * pitch,
                a.label < b.label ? a.label : b.label, a.label < b.label ? b.label : a.label, static_cast<std::int8_t>(axis),
                static_cast<std::int8_t>(a.label < b.label ? 1 : -1), no_border, false};
  std::uint16_t& head = border_in_cell_[static_cast<std::size_t>(cell_of(dem, border))];
  border.next_in_cell = head;
  head = static_cast<std::uint16_t>(borders_);
  border_[static_cast<std::size_t>(borders_++)] = border;
}

/// The nearest border of the same planes that is in no chain yet: within two cells, else as far as gaps are bridged.
template <Limits limits>
std::uint16_t CurbTracer<limits>::nearest(const Dem<limits>& dem, const Border& from) const {
  const std::uint16_t near = nearest_within(dem, from, 2);
  return near != no_border ? near : nearest_within(dem, from, settings_.link_reach);
}

template <Limits limits>
std::uint16_t CurbTracer<limits>::nearest_within(const Dem<limits>& dem, const Border& from, int reach) const {
  const int ci = static_cast<int>(from.x_m / dem.cell_x_m()), cj = static_cast<int>(from.y_m / dem.cell_y_m());
  std::uint16_t best = no_border;
  float best_m2 = 1e30f;
  for (int i = ci > reach ? ci - reach : 0; i <= ci + reach && i < dem.rows(); ++i) {
    for (int j = cj > reach ? cj - reach : 0; j <= cj + reach && j < dem.cols(); ++j) {
      for (std::uint16_t b = border_in_cell_[static_cast<std::size_t>(dem.slot(i, j))]; b != no_border; b = border_[b].next_in_cell) {
        const Border& border = border_[b];
        if (border.chained || border.low != from.low || border.high != from.high) continue;
        const float dx = border.x_m - from.x_m, dy = border.y_m - from.y_m;
        const float m2 = dx * dx + dy * dy;
        if (m2 < best_m2) {
          best_m2 = m2;
          best = b;
        }
      }
    }
  }
  return best;
}

template <Limits limits>
int CurbTracer<limits>::chain(const Dem<limits>& dem, std::uint16_t start) {
  int length = 0;
  for (std::uint16_t b = start; b != no_border; b = nearest(dem, border_[b])) {
    border_[b].chained = true;
    chain_[static_cast<std::size_t>(length++)] = b;
  }
  return length;
}

/// Splits the chain where it leaves the chord by more than a cell (a straight line crossing cells stays within one) and
/// gives out the pieces in order.
template <Limits limits>
void CurbTracer<limits>::cut(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int first, int last, Counters& counters) {
  const float tolerance_m = dem.cell_x_m() > dem.cell_y_m() ? dem.cell_x_m() : dem.cell_y_m();
  do {
    int end = last;
    for (int split = farthest_from_chord(first, end, tolerance_m); split >= 0; split = farthest_from_chord(first, end, tolerance_m)) end = split;
    give_out(dem, mixture, first, end, counters);
    first = end;
  } while (first < last);
}

/// The border farthest from the chord between two others, -1 if none is farther than the tolerance.
template <Limits limits>
int CurbTracer<limits>::farthest_from_chord(int first, int last, float tolerance_m) const {
  const Border& a = border_[chain_[static_cast<std::size_t>(first)]];
  const Border& b = border_[chain_[static_cast<std::size_t>(last)]];
  const float dx = b.x_m - a.x_m, dy = b.y_m - a.y_m;
  const float length2 = dx * dx + dy * dy;
  float worst = tolerance_m * tolerance_m;
  int found = -1;
  for (int k = first + 1; k < last; ++k) {
    const Border& p = border_[chain_[static_cast<std::size_t>(k)]];
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
void CurbTracer<limits>::give_out(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int first, int last, Counters& counters) {
  if (curbs_ == limits.curbs) {
    ++counters.curbs_full;
    return;
  }
  const Border& a = border_[chain_[static_cast<std::size_t>(first)]];
  const Border& b = border_[chain_[static_cast<std::size_t>(last)]];
  const Plane& low = mixture.plane(a.low);
  const Plane& high = mixture.plane(a.high);
  LineFit fit;
  float height = 0.0f, variance = 0.0f, probability = 0.0f, half_gap = 0.0f, toward_x = 0.0f, toward_y = 0.0f;
  for (int k = first; k <= last; ++k) {
    const Border& border = border_[chain_[static_cast<std::size_t>(k)]];
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
  // Planes of different slope that meet within the gap between them are a crease: their heights in its middle differ by no
  // more than the slopes make up across half of it, and what is not known of them (95 %).
  const float slope_x = high.slope_x - low.slope_x, slope_y = high.slope_y - low.slope_y;
  const float across = segment.normal_x * slope_x + segment.normal_y * slope_y;
  const float meet = (across < 0.0f ? -across : across) * half_gap * n + 2.0f * curb.height_sd_m;
  curb.kind = curb.height_m > meet ? CurbKind::step_up : curb.height_m < -meet ? CurbKind::step_down : CurbKind::crease;
  curb_[static_cast<std::size_t>(curbs_++)] = curb;
}

}  // namespace curbline
