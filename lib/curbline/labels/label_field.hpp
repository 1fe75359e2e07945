// Which plane each cell lies on: a Markov random field over the window's cells, its E-step by loopy belief propagation
// (paper, section III-D). Messages are kept from line to line; a call sends them once in each of four directions, from
// the cells that changed, and a new message makes its receiver one of those. A Potts message has two values, so it
// costs O(candidates), not O(K^2): each cell keeps its three most likely labels (label_site.hpp) of the planes near by
// (planes_near_by.hpp). Cost of a call: three passes over the window beside that of planes_near_by, and four messages
// for each cell that sends.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "curbline/counters.hpp"
#include "curbline/labels/label_site.hpp"
#include "curbline/labels/planes_near_by.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/per_cell.hpp"
#include "curbline/planes/plane_mixture.hpp"
#include "curbline/settings.hpp"

namespace curbline {

/// Which cells send messages.
enum class FieldScope : std::uint8_t {
  line,     ///< cells that changed, within max_messages: after each scan line
  changed,  ///< all cells that changed
  window,   ///< all cells
};

template <Limits limits>
class LabelField {
 public:
  /// A cell that sends, its nearest valid neighbours, and the sum of their messages about its candidates.
  struct Visit {
    Slot<limits> slot;
    std::array<Slot<limits>, directions> neighbour;
    std::array<std::uint8_t, directions> distance;  ///< in cells; 0 where there is none
    LabelSite::Heard heard;
  };
  /// Working memory of one update(): the cells that send, row by row, and the place of each in that list.
  struct Visits {
    std::array<Visit, Dem<limits>::capacity> visit;
    PerCell<Slot<limits>, limits> index;
    std::size_t size;

    std::span<Visit> all() { return {visit.data(), size}; }
  };

  [[gnu::cold]] void init(const LabelSettings& settings);

  /// Forgets a cell that leaves the window.
  void forget(int slot) { sites_[slot] = LabelSite{}; }

  /// Marks the touched cells for the next update().
  void note_touched(const Dem<limits>& dem);

  /// E-step. Cells count as changed if they were touched, if their region changed its plane, if a candidate of theirs
  /// is gone, or if they heard a new message; others keep the candidates and potentials of when they last sent, though
  /// planes move as they grow. Cells left over by max_messages are counted and wait for the next call, with the label
  /// of their region if that has changed. Returns how many labels changed.
  int update(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, FieldScope scope, Visits& visits,
             Counters& counters);

  Label label(int slot) const { return sites_[slot].best; }
  /// Posterior of a valid cell. O(label_candidates^2).
  // Not inlined: asked for few cells, in several places.
  [[gnu::noinline]] Belief belief(const Dem<limits>& dem, int slot) const;

 private:
  static constexpr int no_news = 2;  ///< a message that changes by no more, 1/16 nat, is not sent again

  /// Bits: a neighbour's message was news; sends in this call; touched, or left over by max_messages.
  enum Flag : std::uint8_t { quiet = 0, heard = 1, visited = 2, waits = 4 };

  // Not inlined, so that send() is, in the loop over visits: saves 50,000 instructions a line on a Cortex-M7.
  [[gnu::noinline]] void choose_visits(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, FieldScope scope,
                                       Visits& visits, Counters& counters);
  void flag_changed(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, FieldScope scope, Counters& counters);
  bool wants_to_send(const PlaneMixture<limits>& mixture, int slot) const;
  // Not inlined: for cells that send and for those that only hear it would take 300 bytes of flash more.
  [[gnu::noinline]] Visit visit_to(const Dem<limits>& dem, int slot) const;
  void hear_neighbours(Visit& visit) const;
  Visit heard_by(const Dem<limits>& dem, int slot) const;
  void send(const Visit& from, std::size_t direction, Visits& visits);
  int follow_beliefs(const Dem<limits>& dem, std::span<const Visit> visits);
  int follow_belief(const Visit& visit);

  LabelSettings settings_{};
  PlanesNearBy<limits> near_by_{};
  int first_row_ = 0;  ///< row whose cells have the first right to send in the next update()
  std::array<LabelSite::Coupling, max_link_reach + 1> coupling_{};  ///< by distance
  PerCell<LabelSite, limits> sites_{};
  PerCell<std::uint8_t, limits> flag_{};
};

template <Limits limits>
void LabelField<limits>::init(const LabelSettings& settings) {
  settings_ = settings;
  sites_.fill(LabelSite{});
  flag_.fill(quiet);
  near_by_.clear();
  first_row_ = 0;
  for (std::size_t g = 1; g < coupling_.size(); ++g)
    coupling_[g] = LabelSite::coupling(settings.coupling / static_cast<float>(g));
}

template <Limits limits>
int LabelField<limits>::update(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, FieldScope scope,
                               Visits& visits, Counters& counters) {
  near_by_.follow(dem, mixture);
  choose_visits(dem, mixture, scope, visits, counters);
  const std::span<Visit> all = visits.all();
  for (Visit& visit : all) hear_neighbours(visit);
  // Each direction's messages follow its own order, so that one pass carries them across the window.
  for (std::size_t direction = 0; direction < directions; ++direction) {
    const bool forward = direction % 2 == 0;
    for (std::size_t n = 0; n < all.size(); ++n) send(all[forward ? n : all.size() - 1 - n], direction, visits);
  }
  counters.messages += static_cast<std::uint32_t>(directions * visits.size);
  return follow_beliefs(dem, all);
}

template <Limits limits>
void LabelField<limits>::note_touched(const Dem<limits>& dem) {
  dem.for_each_valid([&](int, int, int s) {
    if (dem.touched(s)) flag_[s] |= waits;
  });
}

template <Limits limits>
void LabelField<limits>::choose_visits(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, FieldScope scope,
                                       Visits& visits, Counters& counters) {
  flag_changed(dem, mixture, scope, counters);
  visits.size = 0;
  dem.for_each_valid([&](int i, int j, int s) {
    if ((flag_[s] & visited) == 0) return;
    sites_[s].set_candidates(near_by_.candidates(dem, mixture, i, j, dem.cell(s)), mixture.covered(s));
    visits.index[s] = static_cast<Slot<limits>>(visits.size);
    visits.visit[visits.size++] = visit_to(dem, s);
  });
}

/// Starts where the budget of the last call ended, at least a row further on than that did: in as many calls as all
/// cells need each has sent. Of a large plane that is formed anew, or divided, all cells change at once: one that has
/// to wait, and whose region has another plane now, or whose own is gone or no longer ground, meanwhile bears that of
/// its region; none if that is no ground either.
template <Limits limits>
void LabelField<limits>::flag_changed(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, FieldScope scope,
                                      Counters& counters) {
  const int rows = dem.rows();
  const int first = first_row_ % rows;
  const int of_a_row = directions * dem.cols();
  const int messages = settings_.max_messages.value_or(std::max(5 * rows * dem.cols() / 8, of_a_row));
  int left = scope == FieldScope::line ? messages / directions : Dem<limits>::capacity;
  const auto may_have = [&](Label label) { return label != no_label && mixture.ground(label); };
  for (int a = 0; a < rows; ++a) {
    if (left > 0) first_row_ = first + std::max(a, 1);
    dem.for_each_valid_in_row(first + a < rows ? first + a : first + a - rows, [&](int, int, int s) {
      if (scope != FieldScope::window && !wants_to_send(mixture, s)) {
        flag_[s] = quiet;
      } else if (left > 0) {
        flag_[s] = visited;
        --left;
      } else {
        flag_[s] = waits;
        ++counters.cells_deferred;
        const Label region = mixture.region_label(s);
        const bool none_left = !may_have(sites_[s].best);
        if (may_have(region) && (mixture.relabelled(s) || none_left)) {
          sites_[s].best = region;
        } else if (none_left) {
          sites_[s].best = no_label;
        }
      }
    });
  }
}

/// Whether the cell has changed since it last sent, or has no candidate.
template <Limits limits>
bool LabelField<limits>::wants_to_send(const PlaneMixture<limits>& mixture, int slot) const {
  if ((flag_[slot] & (heard | waits)) != 0 || mixture.relabelled(slot)) return true;
  const LabelSite& site = sites_[slot];
  if (mixture.any_fresh()) {
    if (mixture.region_label(slot) != no_label && mixture.fresh(mixture.region_label(slot))) return true;
    for (const Label label : site.label) {
      if (label != no_label && mixture.fresh(label)) return true;
    }
  }
  return site.label[0] == no_label;
}

template <Limits limits>
auto LabelField<limits>::visit_to(const Dem<limits>& dem, int slot) const -> Visit {
  Visit visit;
  visit.slot = static_cast<Slot<limits>>(slot);
  for (std::size_t d = 0; d < directions; ++d) {
    const int g = dem.next_valid(slot, static_cast<int>(d), settings_.link_reach);
    visit.distance[d] = static_cast<std::uint8_t>(g);
    visit.neighbour[d] = static_cast<Slot<limits>>(dem.slot_beside(slot, static_cast<int>(d), g));
  }
  return visit;
}

/// Call when all candidates are chosen.
template <Limits limits>
void LabelField<limits>::hear_neighbours(Visit& visit) const {
  const LabelSite& site = sites_[visit.slot];
  visit.heard.fill(0);
  for (std::size_t d = 0; d < directions; ++d) {
    if (visit.distance[d] == 0) continue;
    const LabelSite& other = sites_[visit.neighbour[d]];
    site.hear(other.label, other.sent[d ^ 1u], 1, visit.heard);
  }
}

/// A visit of a cell with what it has heard, for cells that are not in the list of visits.
template <Limits limits>
auto LabelField<limits>::heard_by(const Dem<limits>& dem, int slot) const -> Visit {
  Visit here = visit_to(dem, slot);
  hear_neighbours(here);
  return here;
}

/// Sends to the next cell in a direction, and updates the sum of what that has heard, if the message is news.
template <Limits limits>
void LabelField<limits>::send(const Visit& from, std::size_t direction, Visits& visits) {
  const std::size_t distance = from.distance[direction];
  if (distance == 0) return;
  LabelSite& site = sites_[from.slot];
  const LabelSite& other = sites_[from.neighbour[direction]];
  LabelSite::Message message{coupling_[distance].loudest, 0, 0};
  if (!site.decided()) {
    auto by_others = from.heard;
    site.hear(other.label, other.sent[direction ^ 1u], -1, by_others);
    message = LabelSite::message(site.probabilities(by_others), coupling_[distance]);
  }
  auto& sent = site.sent[direction];
  std::array<int, label_candidates> change;
  bool news = false;
  for (std::size_t c = 0; c < message.size(); ++c) {
    change[c] = message[c] - sent[c];
    news |= change[c] > no_news || change[c] < -no_news;
  }
  if (!news) return;
  auto& flag = flag_[from.neighbour[direction]];
  if ((flag & visited) != 0)
    other.hear(site.label, change, 1, visits.visit[visits.index[from.neighbour[direction]]].heard);
  flag |= heard;
  sent = message;
}

/// Updates the most likely label of each cell that was visited or heard something new. Returns how many changed.
template <Limits limits>
int LabelField<limits>::follow_beliefs(const Dem<limits>& dem, std::span<const Visit> visits) {
  int changed = 0;
  for (const Visit& visit : visits) changed += follow_belief(visit);
  dem.for_each_valid([&](int, int, int s) {
    if ((flag_[s] & (visited | heard | waits)) == heard) changed += follow_belief(heard_by(dem, s));
  });
  return changed;
}

/// Returns 1 if the label changed, else 0.
template <Limits limits>
int LabelField<limits>::follow_belief(const Visit& visit) {
  LabelSite& site = sites_[visit.slot];
  const Label best = site.most_likely(visit.heard);
  if (site.best == best) return 0;
  site.best = best;
  return 1;
}

template <Limits limits>
auto LabelField<limits>::belief(const Dem<limits>& dem, int slot) const -> Belief {
  const LabelSite& site = sites_[slot];
  return {site.label, site.probabilities(heard_by(dem, slot).heard)};
}

}  // namespace curbline
