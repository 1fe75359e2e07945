// Curbs: where two planes meet. Border points are found along every row and column of the window (border_finder.hpp),
// chained into polylines by their pair of planes (borders.hpp), and cut into straight pieces of even height, of which
// curb_maker.hpp makes curbs, without creases where the ground is bent (surfaces.hpp). A curb keeps its number from
// call to call. Cost: a pass over the window, 50 look-ups a border point, as many again for one with an empty cell in
// its gap, 60 operations for each border of a chain's rest and each of its pieces, and 20 for each pair of curbs, of
// this call and of this and the last.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "curbline/borders/border_finder.hpp"
#include "curbline/borders/borders.hpp"
#include "curbline/borders/curb_stages.hpp"
#include "curbline/counters.hpp"
#include "curbline/curbs/corner.hpp"
#include "curbline/curbs/curb.hpp"
#include "curbline/curbs/curb_maker.hpp"
#include "curbline/curbs/duplicates.hpp"
#include "curbline/curbs/plane_pair.hpp"
#include "curbline/curbs/surfaces.hpp"
#include "curbline/labels/label_field.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/planes/plane_mixture.hpp"
#include "curbline/settings.hpp"
#include "curbline/sweeps.hpp"

namespace curbline {

template <Limits limits>
class CurbTracer {
 public:
  void init(const CurbSettings& settings) {
    settings_ = settings;
    curbs_ = 0;
    last_id_ = 0;
    surfaces_.init();
  }

  /// Working memory of one trace().
  struct Work {
    Borders<limits> borders;
    std::array<int, limits.borders / 3 + 1> ends;  ///< of a chain's straight parts, of at least three borders
    std::array<Curb, limits.curbs> curb;
    std::array<bool, limits.curbs> is_duplicate;
    std::size_t curbs;
    typename Surfaces<limits>::Work surfaces;

    std::span<Curb> found() { return {curb.data(), curbs}; }
  };

  /// Finds all curbs of the window, in working memory of the caller.
  void trace(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const LabelField<limits>& field,
             const Viewpoint& view, const LatencyDoubt& latency, Work& work, Counters& counters);

  /// The curbs of the last trace(). Valid until the next.
  std::span<const Curb> curbs() const { return {curb_.data(), curbs_}; }
  /// The surfaces within which the last trace() left out creases.
  const Surfaces<limits>& surfaces() const { return surfaces_; }

 private:
  static void divide(CurbMaker<limits>& maker, int length, const Dem<limits>& dem, Work& work, Counters& counters);
  static void cut(CurbMaker<limits>& maker, int start, int stop, Work& work, Counters& counters);
  static void give_out(CurbMaker<limits>& maker, const ChainPart& part, Work& work, Counters& counters);
  template <typename Out>
  static void leave_out(Work& work, Out&& out);
  void keep_ids(Work& work, float near_m);

  CurbSettings settings_{};
  std::array<Curb, limits.curbs> curb_{};
  std::size_t curbs_ = 0;
  std::uint16_t last_id_ = 0;
  Surfaces<limits> surfaces_{};
};

template <Limits limits>
void CurbTracer<limits>::trace(const Dem<limits>& dem, const PlaneMixture<limits>& mixture,
                               const LabelField<limits>& field, const Viewpoint& view, const LatencyDoubt& latency,
                               Work& work, Counters& counters) {
  work.curbs = 0;
  work.borders.clear();
  const CurbStages<limits> stages{dem, mixture, field, view, latency, settings_};
  BorderFinder<limits>(stages).find(work.borders, counters);
  CurbMaker<limits> maker(stages);
  for (int b = 0; b < work.borders.size(); ++b) {
    if (!work.borders.chained(b)) divide(maker, work.borders.chain(dem, b, settings_.link_reach), dem, work, counters);
  }
  leave_out(work, [&](std::size_t k) { return maker.behind_obstacle(work.curb[k]); });
  surfaces_.follow(stages, work.surfaces, work.found());
  leave_out(work, [&](std::size_t k) { return surfaces_.hold(work.curb[k]); });
  const float cell_m = std::max(dem.cell_y_m(), dem.cell_x_m());
  find_duplicates(work.found(), cell_m, work.is_duplicate);
  leave_out(work, [&](std::size_t k) { return work.is_duplicate[k]; });
  keep_ids(work, 2.0f * cell_m);
}

/// Leaves out curb k if out(k).
template <Limits limits>
template <typename Out>
void CurbTracer<limits>::leave_out(Work& work, Out&& out) {
  const std::size_t found = work.curbs;
  work.curbs = 0;
  for (std::size_t k = 0; k < found; ++k) {
    if (!out(k)) work.curb[work.curbs++] = work.curb[k];
  }
}

/// A curb takes the number of the last call's curb that it is most like, a step only that of a step, in the order in
/// which they were found; the others get new numbers.
template <Limits limits>
void CurbTracer<limits>::keep_ids(Work& work, float near_m) {
  const std::span<Curb> found = work.found();
  for (Curb& now : found) {
    Curb* same = nullptr;
    float most_m = 0.0f;
    for (Curb& before : std::span(curb_).first(curbs_)) {
      if (before.id == 0 || is_step(before) != is_step(now)) continue;
      const float alike_m = likeness_m(now, before, near_m);
      if (alike_m <= most_m) continue;
      most_m = alike_m;
      same = &before;
    }
    now.id = 0;
    if (same == nullptr) continue;
    now.id = same->id;
    same->id = 0;  // taken
  }
  const auto new_id = [&] {
    do {
      last_id_ = static_cast<std::uint16_t>(last_id_ == 65535 ? 1 : last_id_ + 1);
    } while (std::ranges::find(found, last_id_, &Curb::id) != found.end());
    return last_id_;
  };
  curbs_ = work.curbs;
  for (std::size_t n = 0; n < found.size(); ++n) {
    curb_[n] = found[n];
    if (curb_[n].id == 0) curb_[n].id = new_id();
  }
}

/// Divides the chain where another edge, of another height, lies between two of its borders. A part of no more borders
/// than there are cells of that edge beside it is none: cells that mix what lies beside them.
template <Limits limits>
void CurbTracer<limits>::divide(CurbMaker<limits>& maker, int length, const Dem<limits>& dem, Work& work,
                                Counters& counters) {
  for (int start = 0, place = 0, cells_before = 0; place < length; ++place) {
    const bool last = place + 1 == length;
    const auto is_other = [&](const Border& there) {
      const auto step_m = [&](const Border& of) { return magnitude(maker.planes_of(of).step_m(there.x_m, there.y_m)); };
      return magnitude(step_m(there) - step_m(work.borders.at(place))) > PlanePair::most_change_m;
    };
    const int cells = last ? 0 : work.borders.other_edge_after(dem, place, is_other);
    if (cells == 0 && !last) continue;
    work.borders.narrow(start, place);
    if (place - start >= std::max(cells, cells_before)) cut(maker, start, place, work, counters);
    start = place + 1;
    cells_before = cells;
  }
}

/// Splits a chain's part at its corners, halves straight parts until their height is even, and gives out the pieces in
/// order.
template <Limits limits>
void CurbTracer<limits>::cut(CurbMaker<limits>& maker, int start, int stop, Work& work, Counters& counters) {
  int first = start;
  const PlanePair planes = maker.planes_of(work.borders.at(first));
  const auto even_to = [&](const Border& to) {
    const Border& from = work.borders.at(first);
    return planes.even(to.x_m - from.x_m, to.y_m - from.y_m);
  };
  std::size_t parts = 0;  // whose ends are known; the next one's end comes last
  work.ends[parts++] = stop;
  while (parts > 0) {
    const int last = work.ends[parts - 1], corner = corner_of(work.borders.part(first, last));
    if (corner >= 0) {
      work.ends[parts++] = first + corner;
      continue;
    }
    --parts;
    while (first <= last) {
      int end = last;
      while (end - first > 1 && !even_to(work.borders.at(end))) end = (first + end) / 2;
      give_out(maker, work.borders.part(first, end), work, counters);
      first = end + 1;
    }
  }
}

/// A full store loses obstacles, too: what is behind them may then be given out.
template <Limits limits>
void CurbTracer<limits>::give_out(CurbMaker<limits>& maker, const ChainPart& part, Work& work, Counters& counters) {
  if (work.curbs == work.curb.size()) {
    ++counters.curbs_full;
    return;
  }
  if (const std::optional<Curb> curb = maker.make(part)) work.curb[work.curbs++] = *curb;
}

}  // namespace curbline
