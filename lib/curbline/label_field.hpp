// Which plane each cell lies on: a Markov random field over the window's cells, its E-step by loopy belief propagation
// (paper, section III-D). Messages are kept from line to line; one call sends them once along each of four directions, from the cells
// that changed, and a message that is new makes its receiver one of those. A Potts message has two values, so it costs O(candidates), not O(K^2): each cell keeps its three most likely
// labels out of the planes near by (those of regions in its block or the eight around it), all others count as impossible for it.
// So two pavements of one height on either side of a road keep their labels apart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "curbline/counters.hpp"
#include "curbline/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/plane_mixture.hpp"
#include "curbline/plane_set.hpp"
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
    std::array<LabelType, candidates> label;     ///< `none` where there are fewer
    std::array<float, candidates> probability;   ///< sums to 1
  };

  struct Place {
    Slot<limits> slot, i, j;
  };
  /// Working memory of one update(): the cells that it visits, row by row.
  struct Visits {
    std::array<Place, Dem<limits>::capacity> place;
    int size;
  };

  void init(const LabelSettings& settings, const PlanePrior& prior);

  /// Forgets a cell that leaves the window.
  void forget(int slot) { sites_[static_cast<std::size_t>(slot)] = Site{}; }

  /// E-step. Changed are cells that a line touched, whose region changed its plane, that bore a label that is no more or heard a
  /// message that was new, and a band of rows that moves on with each call, since planes move as they grow. Returns how many
  /// labels changed. Cells that are left over by max_messages are counted and wait for the next call.
  int update(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, FieldScope scope, Visits& visits, Counters& counters);

  LabelType label(int slot) const { return sites_[static_cast<std::size_t>(slot)].best; }
  /// Posterior of a valid cell. O(candidates^2).
  Belief belief(const Dem<limits>& dem, int i, int j) const;

 private:
  // Messages are kept in 1/32 nat in a byte, node potentials in 1/256 nat below the best: half precision changes nothing.
  static constexpr int message_scale = 32, node_scale = 256;

  struct Site {
    std::array<LabelType, candidates> label{none, none, none};
    LabelType best = none;
    std::array<std::int16_t, candidates> node{};                                ///< log potential of each candidate
    std::array<std::array<std::uint8_t, candidates>, directions> message{};     ///< to the neighbour there, of each candidate
  };
  enum Flag : std::uint8_t { quiet = 0, heard = 1, visited = 2, deferred = 4 };  ///< bits
  using Logs = std::array<float, candidates>;
  using Nats = std::array<std::int32_t, candidates>;  ///< in 1 / node_scale nat
  using Planes = PlaneSet<limits.planes>;

  static std::size_t block_of(const Dem<limits>& dem, int i, int j) {
    return static_cast<std::size_t>((i / block_side) * (dem.cols() / block_side) + j / block_side);
  }

  void choose_visits(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, FieldScope scope, Visits& visits, Counters& counters);
  bool must_visit(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int slot) const;
  void find_planes_near_by(const Dem<limits>& dem, const PlaneMixture<limits>& mixture);
  void choose_candidates(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const Place& place);
  void keep_messages(Site& site, const std::array<LabelType, candidates>& label);
  void send(const Dem<limits>& dem, const Place& from, int direction);
  int follow_beliefs(const Dem<limits>& dem);
  Nats log_belief(const Dem<limits>& dem, int i, int j, int slot, int except) const;
  static void hear(const Site& site, const Site& other, std::size_t direction, Nats& logs);
  static Logs normalised(const Site& site, const Nats& logs);

  LabelSettings settings_{};
  float noise_m2_ = 0.0f;  ///< of a cell with one point of weight 1
  std::array<Planes, capacity / (block_side * block_side)> near_by_{};  ///< of each block of the window
  float near_by_x_m_ = 0.0f, near_by_y_m_ = 0.0f;                       ///< of the window then
  int band_ = 0;  ///< first row to refresh in the next update()
  std::array<float, max_link_reach + 1> boost_{};         ///< exp(J / distance) - 1
  std::array<std::uint8_t, max_link_reach + 1> loudest_{};  ///< message of a cell that is sure
  std::array<Site, Dem<limits>::capacity> sites_{};
  std::array<std::uint8_t, Dem<limits>::capacity> flag_{};
};

template <Limits limits>
void LabelField<limits>::init(const LabelSettings& settings, const PlanePrior& prior) {
  settings_ = settings;
  noise_m2_ = prior.noise_m2;
  sites_.fill(Site{});
  flag_.fill(quiet);
  near_by_.fill({});
  band_ = 0;
  for (std::size_t g = 1; g < boost_.size(); ++g) {
    boost_[g] = exp(settings.coupling / static_cast<float>(g)) - 1.0f;
    loudest_[g] = static_cast<std::uint8_t>(round_to_int(settings.coupling / static_cast<float>(g) * float{message_scale}));
  }
}

template <Limits limits>
int LabelField<limits>::update(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, FieldScope scope, Visits& visits,
                               Counters& counters) {
  find_planes_near_by(dem, mixture);
  choose_visits(dem, mixture, scope, visits, counters);
  for (int n = 0; n < visits.size; ++n) choose_candidates(dem, mixture, visits.place[static_cast<std::size_t>(n)]);
  // Each direction's messages follow its own order, so that one pass carries them across the window.
  for (int direction = 0; direction < directions; ++direction) {
    const bool forward = direction % 2 == 0;
    for (int n = 0; n < visits.size; ++n) send(dem, visits.place[static_cast<std::size_t>(forward ? n : visits.size - 1 - n)], direction);
  }
  counters.messages += static_cast<std::uint32_t>(directions * visits.size);
  return follow_beliefs(dem);
}

/// What changed first, from a row that moves on, so that a budget that is too small starves none; then the band of rows.
template <Limits limits>
void LabelField<limits>::choose_visits(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, FieldScope scope, Visits& visits,
                                       Counters& counters) {
  const int rows = dem.rows();
  const int first = band_ < rows ? band_ : 0;
  band_ = first + settings_.refresh_rows;
  int left = scope == FieldScope::line ? settings_.max_messages / directions : capacity;
  const auto wanted = [&](int s) {
    return scope == FieldScope::window || (flag_[static_cast<std::size_t>(s)] & (heard | deferred)) != 0 || must_visit(dem, mixture, s);
  };
  for (int a = 0; a < rows; ++a) {
    dem.for_each_valid_in_row(first + a < rows ? first + a : first + a - rows, [&](int, int, int s) {
      auto& flag = flag_[static_cast<std::size_t>(s)];
      flag = !wanted(s) ? quiet : left > 0 ? visited : deferred;
      left -= flag == visited;
      counters.cells_deferred += flag == deferred;
    });
  }
  visits.size = 0;
  dem.for_each_valid([&](int i, int j, int s) {
    auto& flag = flag_[static_cast<std::size_t>(s)];
    if (flag == quiet && i >= first && i < band_ && left > 0) {
      flag = visited;
      --left;
    }
    if (flag != visited) return;
    visits.place[static_cast<std::size_t>(visits.size++)] = {static_cast<Slot<limits>>(s), static_cast<Slot<limits>>(i), static_cast<Slot<limits>>(j)};
  });
}

template <Limits limits>
bool LabelField<limits>::must_visit(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int slot) const {
  if (dem.touched(slot) || mixture.relabelled(slot)) return true;
  const Site& site = sites_[static_cast<std::size_t>(slot)];
  if (mixture.any_fresh()) {
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

/// Node potentials: Student t with 6 degrees of freedom about the plane, the most likely three kept.
template <Limits limits>
void LabelField<limits>::choose_candidates(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const Place& place) {
  const Cell& cell = dem.cell(place.slot);
  const float x = dem.centroid_x_m(place.i, cell), y = dem.centroid_y_m(place.j, cell);
  const float cell_variance = noise_m2_ / cell.weight;
  Logs best{};
  std::array<LabelType, candidates> label{none, none, none};
  const auto consider = [&](int k) {
    const Plane& plane = mixture.plane(k);
    if (!plane.alive()) return;
    const float variance = plane.variance_m2 + cell_variance;
    const float residual = cell.height_m - plane.height_m(x, y);
    float u = 1.0f + residual * residual / (6.0f * variance);
    if (u > 1e5f) u = 1e5f;  // its seventh power must stay finite
    const float u3 = u * u * u;
    const float log_potential = -0.5f * log(variance * u3 * u3 * u);
    std::size_t rank = candidates;
    while (rank > 0 && (label[rank - 1] == none || log_potential > best[rank - 1])) --rank;
    if (rank == candidates) return;
    for (std::size_t c = candidates - 1; c > rank; --c) {
      label[c] = label[c - 1];
      best[c] = best[c - 1];
    }
    label[rank] = static_cast<LabelType>(k);
    best[rank] = log_potential;
  };
  near_by_[block_of(dem, place.i, place.j)].for_each(consider);
  if (label[0] == none) {
    for (int k = 0; k < limits.planes; ++k) consider(k);
  }
  Site& site = sites_[place.slot];
  if (label != site.label) keep_messages(site, label);
  for (std::size_t c = 0; c < candidates; ++c) {
    const float below = label[c] == none ? 0.0f : best[c] - best[0];
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

/// Log belief of each candidate from its node and the messages from all neighbours but the one at `except`.
template <Limits limits>
auto LabelField<limits>::log_belief(const Dem<limits>& dem, int i, int j, int slot, int except) const -> Nats {
  const Site& site = sites_[static_cast<std::size_t>(slot)];
  Nats logs{};
  for (int d = 0; d < directions; ++d) {
    const int g = dem.next_valid(slot, d, settings_.link_reach);
    if (g == 0 || d == except) continue;
    const auto n = static_cast<std::size_t>(d);
    hear(site, sites_[static_cast<std::size_t>(dem.slot(i + g * step_i[n], j + g * step_j[n]))], n ^ 1u, logs);
  }
  for (std::size_t c = 0; c < candidates; ++c) logs[c] = site.node[c] + logs[c] * (node_scale / message_scale);
  return logs;
}

/// Adds what a neighbour says in a direction of the labels that both may bear.
template <Limits limits>
void LabelField<limits>::hear(const Site& site, const Site& other, std::size_t direction, Nats& logs) {
  const auto& message = other.message[direction];
  if (site.label == other.label) {
    for (std::size_t c = 0; c < candidates; ++c) logs[c] += message[c];
    return;
  }
  for (std::size_t c = 0; c < candidates && site.label[c] != none; ++c) {
    for (std::size_t o = 0; o < candidates; ++o) {
      if (site.label[c] == other.label[o]) logs[c] += message[o];
    }
  }
}

template <Limits limits>
auto LabelField<limits>::normalised(const Site& site, const Nats& logs) -> Logs {
  constexpr std::int32_t nothing = -16 * node_scale;  // below it no message and no printed probability changes
  std::int32_t top = logs[0];
  for (std::size_t c = 1; c < candidates; ++c) {
    if (site.label[c] != none && logs[c] > top) top = logs[c];
  }
  Logs p{};
  float sum = 0.0f;
  for (std::size_t c = 0; c < candidates; ++c) {
    const std::int32_t below = logs[c] - top;
    p[c] = site.label[c] == none || below < nothing ? 0.0f : below == 0 ? 1.0f : exp(static_cast<float>(below) * (1.0f / node_scale));
    sum += p[c];
  }
  if (!(sum > 1.0f)) return p;
  for (float& value : p) value /= sum;
  return p;
}

/// Potts message, normalised to 1 for labels that the sender rules out: m(l) = 1 + (exp(J/g) - 1) p(l), p the sender's belief
/// without what the receiver told it. At most exp(J).
template <Limits limits>
void LabelField<limits>::send(const Dem<limits>& dem, const Place& from, int direction) {
  const int g = dem.next_valid(from.slot, direction, settings_.link_reach);
  if (g == 0) return;
  const auto d = static_cast<std::size_t>(direction), distance = static_cast<std::size_t>(g);
  Site& site = sites_[from.slot];
  std::array<std::uint8_t, candidates> message{loudest_[distance], 0, 0};
  if (site.label[1] != none) {
    const Logs p = normalised(site, log_belief(dem, from.i, from.j, from.slot, direction));
    for (std::size_t c = 0; c < candidates; ++c) {
      message[c] = p[c] == 0.0f   ? std::uint8_t{0}
                   : p[c] == 1.0f ? loudest_[distance]
                                  : static_cast<std::uint8_t>(round_to_int(log(1.0f + boost_[distance] * p[c]) * float{message_scale}));
    }
  }
  if (message == site.message[d]) return;
  site.message[d] = message;
  flag_[static_cast<std::size_t>(dem.slot(from.i + g * step_i[d], from.j + g * step_j[d]))] |= heard;
}

/// The most likely label of each cell that was visited or heard something new. Returns how many changed.
template <Limits limits>
int LabelField<limits>::follow_beliefs(const Dem<limits>& dem) {
  int changed = 0;
  dem.for_each_valid([&](int i, int j, int s) {
    if (flag_[static_cast<std::size_t>(s)] == quiet) return;
    Site& site = sites_[static_cast<std::size_t>(s)];
    std::size_t best = 0;
    if (site.label[1] != none) {
      const Nats logs = log_belief(dem, i, j, s, -1);
      for (std::size_t c = 1; c < candidates; ++c) {
        if (site.label[c] != none && logs[c] > logs[best]) best = c;
      }
    }
    changed += site.best != site.label[best];
    site.best = site.label[best];
  });
  return changed;
}

template <Limits limits>
auto LabelField<limits>::belief(const Dem<limits>& dem, int i, int j) const -> Belief {
  const int s = dem.slot(i, j);
  const Site& site = sites_[static_cast<std::size_t>(s)];
  return {site.label, normalised(site, log_belief(dem, i, j, s, -1))};
}

}  // namespace curbline
