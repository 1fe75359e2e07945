// Which plane each cell lies on: a Markov random field over the window's cells, its E-step by loopy belief propagation
// (paper, section III-D). Messages are kept from line to line; one call sends them once along each of four directions,
// from the cells that changed, and a message that is new makes its receiver one of those. A Potts message has two
// values, so it costs O(candidates), not O(K^2): each cell keeps its three most likely labels out of the planes near by
// (those of regions in its block or the eight around it), all others count as impossible for it. So two pavements of
// one height on either side of a road keep their labels apart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "curbline/counters.hpp"
#include "curbline/dem.hpp"
#include "curbline/index_set.hpp"
#include "curbline/math.hpp"
#include "curbline/plane_mixture.hpp"
#include "curbline/settings.hpp"

namespace curbline {

/// Which cells send messages.
enum class FieldScope : std::uint8_t {
  line,     ///< what changed, within max_messages: after each scan line
  changed,  ///< what changed, all of it
  window,   ///< every cell
};

template <Limits limits>
class LabelField {
 public:
  using LabelType = Label<limits>;
  static constexpr LabelType none = no_label<limits>;
  static constexpr int candidates = 3;
  static constexpr int capacity = Dem<limits>::capacity;

  struct Belief {
    std::array<LabelType, candidates> label;    ///< `none` where there are fewer
    std::array<float, candidates> probability;  ///< sums to 1

    /// Probability of one label, 0 if it is no candidate.
    float of(LabelType wanted) const {
      float found = 0.0f;
      for (std::size_t c = 0; c < label.size(); ++c) {
        if (label[c] == wanted) found = probability[c];
      }
      return found;
    }
  };

  /// A cell that sends, its nearest valid neighbours, and what they say of its candidates, all together.
  struct Place {
    Slot<limits> slot;
    std::array<Slot<limits>, directions> neighbour;
    std::array<std::uint8_t, directions> distance;  ///< in cells; 0 where there is none
    std::uint8_t same_labels;                       ///< a bit a direction: the neighbour has the same candidates
    std::array<std::int16_t, candidates> heard;     ///< in 1 / message_scale nat
  };
  /// Working memory of one update(): the cells that send, row by row, and where in that list a cell is.
  struct Visits {
    std::array<Place, Dem<limits>::capacity> place;
    std::array<Slot<limits>, Dem<limits>::capacity> index;
    int size;
  };

  void init(const LabelSettings& settings);

  /// Forgets a cell that leaves the window.
  void forget(int slot) { sites_[static_cast<std::size_t>(slot)] = Site{}; }

  /// The cells that were touched are to be looked at by the next update().
  void note_touched(const Dem<limits>& dem);

  /// E-step. Changed are cells that were noted as touched, whose region changed its plane, that bore a label that is no
  /// more or heard a message that was new, and a band of rows that moves on with each call, since planes move as they
  /// grow. Returns how many labels changed. Cells that are left over by max_messages are counted and wait for the next
  /// call.
  int update(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, FieldScope scope, Visits& visits,
             Counters& counters);

  LabelType label(int slot) const { return sites_[static_cast<std::size_t>(slot)].best; }
  /// Posterior of a valid cell. O(candidates^2).
  Belief belief(const Dem<limits>& dem, int i, int j) const;

 private:
  // Messages are kept in 1/32 nat in a byte, node potentials in 1/256 nat below the best: half precision changes
  // nothing.
  static constexpr int message_scale = 32, node_scale = 256;
  static constexpr int no_news = 2;  ///< a message that differs by so little, 1/16 nat, is not sent again

  using Message = std::array<std::uint8_t, candidates>;  ///< of each candidate of the sender
  struct Site {
    std::array<LabelType, candidates> label{none, none, none};
    LabelType best = none;
    std::array<std::int16_t, candidates> node{};  ///< log potential of each candidate
    std::array<Message, directions> message{};    ///< to the neighbour there
  };
  /// Bits; renew: its candidates too.
  enum Flag : std::uint8_t { quiet = 0, heard = 1, visited = 2, deferred = 4, renew = 8 };
  using Logs = std::array<float, candidates>;
  using Nats = std::array<std::int32_t, candidates>;  ///< in 1 / node_scale nat
  using Planes = IndexSet<limits.planes>;

  static std::size_t block_of(const Dem<limits>& dem, int i, int j) {
    return static_cast<std::size_t>((i / block_side) * (dem.cols() / block_side) + j / block_side);
  }

  void choose_visits(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, FieldScope scope, Visits& visits,
                     Counters& counters);
  bool must_renew(const PlaneMixture<limits>& mixture, int slot) const;
  void find_planes_near_by(const Dem<limits>& dem, const PlaneMixture<limits>& mixture);
  void choose_candidates(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int i, int j, int slot);
  void keep_messages(Site& site, const std::array<LabelType, candidates>& label);
  Place place(const Dem<limits>& dem, int i, int j, int slot) const;
  void hear_neighbours(Place& place) const;
  static void hear(const Site& site, const std::array<LabelType, candidates>& label, const Message& message,
                   bool same_labels, int sign, std::array<std::int16_t, candidates>& sum);
  void send(const Place& from, std::size_t direction, Visits& visits);
  int follow_beliefs(const Dem<limits>& dem, const Visits& visits);
  int follow_belief(const Place& place);
  static Nats log_belief(const Site& site, const std::array<std::int16_t, candidates>& sum);
  static Logs normalised(const Site& site, const Nats& logs);

  LabelSettings settings_{};
  std::array<Planes, capacity / (block_side * block_side)> near_by_{};  ///< of each block of the window
  float near_by_x_m_ = 0.0f, near_by_y_m_ = 0.0f;                       ///< of the window then
  int band_ = 0;                                                        ///< first row to refresh in the next update()
  int first_row_ = 0;                                                   ///< whose cells may send first in it
  std::array<float, max_link_reach + 1> boost_{};                       ///< exp(J / distance) - 1
  std::array<std::uint8_t, max_link_reach + 1> loudest_{};              ///< message of a cell that is sure
  std::array<Site, Dem<limits>::capacity> sites_{};
  std::array<std::uint8_t, Dem<limits>::capacity> flag_{};
};

template <Limits limits>
void LabelField<limits>::init(const LabelSettings& settings) {
  settings_ = settings;
  sites_.fill(Site{});
  flag_.fill(quiet);
  near_by_.fill({});
  band_ = first_row_ = 0;
  for (std::size_t g = 1; g < boost_.size(); ++g) {
    boost_[g] = exp(settings.coupling / static_cast<float>(g)) - 1.0f;
    loudest_[g] =
        static_cast<std::uint8_t>(round_to_int(settings.coupling / static_cast<float>(g) * float{message_scale}));
  }
}

template <Limits limits>
int LabelField<limits>::update(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, FieldScope scope,
                               Visits& visits, Counters& counters) {
  find_planes_near_by(dem, mixture);
  choose_visits(dem, mixture, scope, visits, counters);
  const std::span<Place> places(visits.place.data(), static_cast<std::size_t>(visits.size));
  for (Place& place : places) hear_neighbours(place);
  // Each direction's messages follow its own order, so that one pass carries them across the window.
  for (std::size_t direction = 0; direction < directions; ++direction) {
    const bool forward = direction % 2 == 0;
    for (std::size_t n = 0; n < places.size(); ++n)
      send(places[forward ? n : places.size() - 1 - n], direction, visits);
  }
  counters.messages += static_cast<std::uint32_t>(directions * visits.size);
  return follow_beliefs(dem, visits);
}

template <Limits limits>
void LabelField<limits>::note_touched(const Dem<limits>& dem) {
  dem.for_each_valid([&](int, int, int s) {
    if (dem.touched(s)) flag_[static_cast<std::size_t>(s)] |= renew;
  });
}

/// What changed first, from a row that moves on, so that a budget that is too small starves none as long as it holds a
/// row's cells; then the band of rows.
template <Limits limits>
void LabelField<limits>::choose_visits(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, FieldScope scope,
                                       Visits& visits, Counters& counters) {
  const int rows = dem.rows();
  const int first = first_row_ < rows ? first_row_ : 0;
  first_row_ = first + 1;
  const int band = band_ < rows ? band_ : 0;
  band_ = band + settings_.refresh_rows;
  int left = scope == FieldScope::line ? settings_.max_messages / directions : capacity;
  /// `visited`, with `renew` or without, or `quiet`.
  const auto wanted = [&](int s) -> std::uint8_t {
    const std::uint8_t before = flag_[static_cast<std::size_t>(s)];
    if ((before & renew) != 0 || scope == FieldScope::window || must_renew(mixture, s)) return visited | renew;
    if ((before & (heard | deferred)) == 0) return quiet;
    return mixture.any_relabelled() ? visited | renew : visited;  // planes near by may be others
  };
  for (int a = 0; a < rows; ++a) {
    dem.for_each_valid_in_row(first + a < rows ? first + a : first + a - rows, [&](int, int, int s) {
      auto& flag = flag_[static_cast<std::size_t>(s)];
      flag = wanted(s);
      if (flag == quiet) return;
      if (left > 0) {
        --left;
      } else {
        flag ^= visited | deferred;
        ++counters.cells_deferred;
      }
    });
  }
  visits.size = 0;
  dem.for_each_valid([&](int i, int j, int s) {
    auto& flag = flag_[static_cast<std::size_t>(s)];
    if (flag == quiet && i >= band && i < band_ && left > 0) {
      flag = visited | renew;
      --left;
    }
    if ((flag & visited) == 0) return;
    if ((flag & renew) != 0) choose_candidates(dem, mixture, i, j, s);
    flag = visited;
    visits.index[static_cast<std::size_t>(s)] = static_cast<Slot<limits>>(visits.size);
    visits.place[static_cast<std::size_t>(visits.size++)] = place(dem, i, j, s);
  });
}

template <Limits limits>
bool LabelField<limits>::must_renew(const PlaneMixture<limits>& mixture, int slot) const {
  if (mixture.relabelled(slot)) return true;
  const Site& site = sites_[static_cast<std::size_t>(slot)];
  if (mixture.any_fresh()) {
    if (mixture.region_label(slot) != none && mixture.fresh(mixture.region_label(slot))) return true;
    for (const LabelType label : site.label) {
      if (label != none && mixture.fresh(label)) return true;
    }
  }
  return site.label[0] == none;
}

/// The planes of the regions in each block and those around it.
template <Limits limits>
void LabelField<limits>::find_planes_near_by(const Dem<limits>& dem, const PlaneMixture<limits>& mixture) {
  if (!mixture.any_relabelled() && near_by_x_m_ == dem.origin_x_m() && near_by_y_m_ == dem.origin_y_m()) return;
  near_by_x_m_ = dem.origin_x_m();
  near_by_y_m_ = dem.origin_y_m();
  near_by_.fill({});
  for (int i = 0; i < dem.rows(); i += block_side) {
    for (int j = 0; j < dem.cols(); j += block_side) {
      Planes here;
      for (int k = 0; k < block_side * block_side; ++k) {
        const int s = dem.slot(i + k / block_side, j + k % block_side);
        const LabelType label = mixture.region_label(s);
        if (dem.cell(s).valid() && label != none) here.insert(label);
      }
      for (int a = i - block_side; a <= i + block_side; a += block_side) {
        for (int b = j - block_side; b <= j + block_side; b += block_side) {
          if (a >= 0 && b >= 0 && a < dem.rows() && b < dem.cols()) near_by_[block_of(dem, a, b)].insert(here);
        }
      }
    }
  }
}

/// Node potentials: Student t with 6 degrees of freedom about the plane, the most likely three kept. Where the ground
/// is covered they are alike, and the cells around decide.
template <Limits limits>
void LabelField<limits>::choose_candidates(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int i, int j,
                                           int slot) {
  const Cell& cell = dem.cell(slot);
  const float x = dem.centroid_x_m(i, cell), y = dem.centroid_y_m(j, cell);
  const float cell_variance = dem.height_variance_m2(cell);
  std::array<float, candidates> doubt{};  // exp(-2 log potential): a logarithm each of those that are kept is enough
  std::array<LabelType, candidates> label{none, none, none};
  const auto consider = [&](int k) {
    const Plane& plane = mixture.plane(k);
    if (!plane.alive() || !mixture.ground(k)) return;
    const float variance = plane.variance_m2 + cell_variance;
    const float residual = cell.height_m - plane.height_m(x, y);
    float u = 1.0f + residual * residual / (6.0f * variance);
    if (u > 1e4f) u = 1e4f;  // its seventh power, and a ratio of two, must stay finite
    const float u3 = u * u * u;
    const float doubted = variance * u3 * u3 * u;
    std::size_t rank = candidates;
    while (rank > 0 && (label[rank - 1] == none || doubted < doubt[rank - 1])) --rank;
    if (rank == candidates) return;
    for (std::size_t c = candidates - 1; c > rank; --c) {
      label[c] = label[c - 1];
      doubt[c] = doubt[c - 1];
    }
    label[rank] = static_cast<LabelType>(k);
    doubt[rank] = doubted;
  };
  near_by_[block_of(dem, i, j)].for_each(consider);
  if (label[0] == none) {
    for (int k = 0; k < limits.planes; ++k) consider(k);
  }
  Site& site = sites_[static_cast<std::size_t>(slot)];
  if (label != site.label) keep_messages(site, label);
  site.node.fill(0);
  if (mixture.covered(slot)) return;
  for (std::size_t c = 1; c < candidates && label[c] != none; ++c) {
    const float below = -0.5f * log(doubt[c] / doubt[0]);
    site.node[c] = static_cast<std::int16_t>(round_to_int((below < -127.0f ? -127.0f : below) * float{node_scale}));
  }
}

/// Candidates in another order, or others: what was said of a label stays with it.
template <Limits limits>
void LabelField<limits>::keep_messages(Site& site, const std::array<LabelType, candidates>& label) {
  for (auto& message : site.message) {
    const auto before = message;
    for (std::size_t c = 0; c < candidates; ++c) {
      message[c] = 0;
      for (std::size_t o = 0; o < candidates; ++o) {
        if (label[c] != none && site.label[o] == label[c]) message[c] = before[o];
      }
    }
  }
  site.label = label;
}

template <Limits limits>
auto LabelField<limits>::place(const Dem<limits>& dem, int i, int j, int slot) const -> Place {
  Place place;
  place.slot = static_cast<Slot<limits>>(slot);
  for (std::size_t d = 0; d < directions; ++d) {
    const int g = dem.next_valid(slot, static_cast<int>(d), settings_.link_reach);
    place.distance[d] = static_cast<std::uint8_t>(g);
    place.neighbour[d] = static_cast<Slot<limits>>(g == 0 ? slot : dem.slot(i + g * step_i[d], j + g * step_j[d]));
  }
  return place;
}

/// When all candidates are chosen.
template <Limits limits>
void LabelField<limits>::hear_neighbours(Place& place) const {
  const Site& site = sites_[place.slot];
  place.same_labels = 0;
  place.heard.fill(0);
  for (std::size_t d = 0; d < directions; ++d) {
    if (place.distance[d] == 0) continue;
    const Site& other = sites_[place.neighbour[d]];
    const bool same = site.label == other.label;
    place.same_labels |= static_cast<std::uint8_t>(same << d);
    hear(site, other.label, other.message[d ^ 1u], same, 1, place.heard);
  }
}

/// Adds (sign 1) or takes away (-1) what a neighbour says of the labels that both may bear.
template <Limits limits>
void LabelField<limits>::hear(const Site& site, const std::array<LabelType, candidates>& label, const Message& message,
                              bool same_labels, int sign, std::array<std::int16_t, candidates>& sum) {
  if (same_labels) {
    for (std::size_t c = 0; c < candidates; ++c) sum[c] = static_cast<std::int16_t>(sum[c] + sign * message[c]);
    return;
  }
  for (std::size_t c = 0; c < candidates && site.label[c] != none; ++c) {
    for (std::size_t o = 0; o < candidates; ++o) {
      if (site.label[c] == label[o]) sum[c] = static_cast<std::int16_t>(sum[c] + sign * message[o]);
    }
  }
}

/// Log belief of each candidate, from its node and what was heard.
template <Limits limits>
auto LabelField<limits>::log_belief(const Site& site, const std::array<std::int16_t, candidates>& sum) -> Nats {
  Nats logs;
  for (std::size_t c = 0; c < candidates; ++c) logs[c] = site.node[c] + sum[c] * (node_scale / message_scale);
  return logs;
}

template <Limits limits>
auto LabelField<limits>::normalised(const Site& site, const Nats& logs) -> Logs {
  constexpr std::int32_t nothing = -8 * node_scale;  // below it no message changes
  std::int32_t top = logs[0];
  for (std::size_t c = 1; c < candidates; ++c) {
    if (site.label[c] != none && logs[c] > top) top = logs[c];
  }
  Logs p{};
  float sum = 0.0f;
  for (std::size_t c = 0; c < candidates; ++c) {
    const std::int32_t below = logs[c] - top;
    p[c] = site.label[c] == none || below < nothing ? 0.0f
           : below == 0                             ? 1.0f
                                                    : exp(static_cast<float>(below) * (1.0f / node_scale));
    sum += p[c];
  }
  if (!(sum > 1.0f)) return p;
  for (float& value : p) value /= sum;
  return p;
}

/// Potts message, normalised to 1 for labels that the sender rules out: m(l) = 1 + (exp(J/g) - 1) p(l), p the sender's
/// belief without what the receiver told it. At most exp(J).
template <Limits limits>
void LabelField<limits>::send(const Place& from, std::size_t direction, Visits& visits) {
  const std::size_t distance = from.distance[direction];
  if (distance == 0) return;
  Site& site = sites_[from.slot];
  const Site& other = sites_[from.neighbour[direction]];
  const bool same = (from.same_labels >> direction & 1) != 0;
  Message message{loudest_[distance], 0, 0};
  if (site.label[1] != none) {
    auto by_others = from.heard;
    hear(site, other.label, other.message[direction ^ 1u], same, -1, by_others);
    const Logs p = normalised(site, log_belief(site, by_others));
    for (std::size_t c = 0; c < candidates; ++c) {
      message[c] =
          p[c] == 0.0f ? std::uint8_t{0}
          : p[c] == 1.0f
              ? loudest_[distance]
              : static_cast<std::uint8_t>(round_to_int(log(1.0f + boost_[distance] * p[c]) * float{message_scale}));
    }
  }
  auto& sent = site.message[direction];
  bool news = false;
  for (std::size_t c = 0; c < candidates; ++c) {
    const int change = message[c] - sent[c];
    news |= change > no_news || change < -no_news;
  }
  if (!news) return;
  auto& flag = flag_[from.neighbour[direction]];
  if ((flag & visited) != 0) {
    auto& sum = visits.place[visits.index[from.neighbour[direction]]].heard;
    hear(other, site.label, sent, same, -1, sum);
    hear(other, site.label, message, same, 1, sum);
  }
  flag |= heard;
  sent = message;
}

/// The most likely label of each cell that was visited or heard something new. Returns how many changed.
template <Limits limits>
int LabelField<limits>::follow_beliefs(const Dem<limits>& dem, const Visits& visits) {
  int changed = 0;
  for (int n = 0; n < visits.size; ++n) changed += follow_belief(visits.place[static_cast<std::size_t>(n)]);
  dem.for_each_valid([&](int i, int j, int s) {
    const auto flag = flag_[static_cast<std::size_t>(s)];
    if (flag == quiet || (flag & visited) != 0) return;
    Place heard_only = place(dem, i, j, s);
    hear_neighbours(heard_only);
    changed += follow_belief(heard_only);
  });
  return changed;
}

/// 1 if it changed.
template <Limits limits>
int LabelField<limits>::follow_belief(const Place& place) {
  Site& site = sites_[place.slot];
  std::size_t best = 0;
  if (site.label[1] != none) {
    const Nats logs = log_belief(site, place.heard);
    for (std::size_t c = 1; c < candidates; ++c) {
      if (site.label[c] != none && logs[c] > logs[best]) best = c;
    }
  }
  if (site.best == site.label[best]) return 0;
  site.best = site.label[best];
  return 1;
}

template <Limits limits>
auto LabelField<limits>::belief(const Dem<limits>& dem, int i, int j) const -> Belief {
  const int slot = dem.slot(i, j);
  const Site& site = sites_[static_cast<std::size_t>(slot)];
  if (site.label[1] == none) return {site.label, {site.label[0] == none ? 0.0f : 1.0f, 0.0f, 0.0f}};
  Place here = place(dem, i, j, slot);
  hear_neighbours(here);
  return {site.label, normalised(site, log_belief(site, here.heard))};
}

}  // namespace curbline
