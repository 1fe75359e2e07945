// Which plane each cell lies on: a Markov random field over the window's cells, its E-step by loopy belief propagation
// (paper, section III-D). Messages are kept from line to line; one call sends them once along each of four directions, from the cells
// that changed, and a message that is new makes its receiver one of those. A Potts message has two values, so it costs O(candidates), not O(K^2): each cell keeps its three most likely
// labels out of the planes near by (those of regions in its block or the eight around it), all others count as impossible for it.
// So two pavements of one height on either side of a road keep their labels apart.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>

#include "curbline/counters.hpp"
#include "curbline/dem.hpp"
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
    std::array<LabelType, candidates> label;     ///< `none` where there are fewer
    std::array<float, candidates> probability;   ///< sums to 1
  };

  void init(const LabelSettings& settings, const PlanePrior& prior);

  /// Forgets a cell that leaves the window.
  void forget(int slot) { sites_[static_cast<std::size_t>(slot)] = Site{}; }

  /// E-step. Changed are cells that a line touched, whose region changed its plane, that bore a label that is no more or heard a
  /// message that was new, and a band of rows that moves on with each call, since planes move as they grow. Returns how many
  /// labels changed. Cells that are left over by max_messages are counted and wait for the next call.
  int update(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, FieldScope scope, Counters& counters);

  LabelType label(int slot) const { return sites_[static_cast<std::size_t>(slot)].best; }
  /// Posterior of a valid cell. O(candidates^2).
  Belief belief(const Dem<limits>& dem, int i, int j) const;

 private:
  // Messages are kept in 1/32 nat in a byte, node potentials in 1/256 nat below the best: half precision changes nothing.
  static constexpr float message_scale = 32.0f, node_scale = 256.0f;
  static constexpr int directions = 4;  ///< +x, -x, +y, -y: d ^ 1 is opposite
  static constexpr std::array<int, directions> step_i{1, -1, 0, 0}, step_j{0, 0, 1, -1};

  struct Site {
    std::array<LabelType, candidates> label{none, none, none};
    LabelType best = none;
    std::array<std::int16_t, candidates> node{};                                ///< log potential of each candidate
    std::array<std::array<std::uint8_t, candidates>, directions> message{};     ///< to the neighbour there, of each candidate
  };
  enum Flag : std::uint8_t { quiet = 0, heard = 1, visited = 2, deferred = 4 };  ///< bits
  using Logs = std::array<float, candidates>;
  using Planes = std::bitset<limits.planes>;

  static std::size_t block_of(const Dem<limits>& dem, int i, int j) {
    return static_cast<std::size_t>((i / block_side) * (dem.cols() / block_side) + j / block_side);
  }

  void find_planes_near_by(const Dem<limits>& dem, const PlaneMixture<limits>& mixture);
  void choose_candidates(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int i, int j, Site& site);
  bool must_visit(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int slot) const;
  void send(const Dem<limits>& dem, int i, int j, int direction);
  Logs log_belief(const Dem<limits>& dem, int i, int j, int except) const;
  static Logs normalised(const Site& site, const Logs& logs);

  LabelSettings settings_{};
  float noise_m2_ = 0.0f;  ///< of a cell with one point of weight 1
  std::array<Planes, capacity / (block_side * block_side)> near_by_{};  ///< of each block; of one update()
  int band_ = 0;  ///< first row to refresh in the next update()
  std::array<float, 65> boost_{};  ///< exp(J / distance) - 1
  std::array<Site, Dem<limits>::capacity> sites_{};
  std::array<std::uint8_t, Dem<limits>::capacity> flag_{};
};

template <Limits limits>
void LabelField<limits>::init(const LabelSettings& settings, const PlanePrior& prior) {
  settings_ = settings;
  noise_m2_ = prior.noise_m2;
  sites_.fill(Site{});
  flag_.fill(quiet);
  band_ = 0;
  for (std::size_t g = 1; g < boost_.size(); ++g) boost_[g] = exp(settings.coupling / static_cast<float>(g)) - 1.0f;
}

template <Limits limits>
int LabelField<limits>::update(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, FieldScope scope, Counters& counters) {
  const int rows = dem.rows(), cols = dem.cols();
  find_planes_near_by(dem, mixture);
  const int band = band_ < rows ? band_ : 0;
  band_ = band + settings_.refresh_rows;
  int visits_left = scope == FieldScope::line ? settings_.max_messages / directions : capacity;
  // What changed first, from a row that moves on, so that a budget that is too small starves none; then the band of rows.
  for (int a = 0; a < rows; ++a) {
    const int i = band + a < rows ? band + a : band + a - rows;
    for (int j = 0; j < cols; ++j) {
      const int s = dem.slot(i, j);
      const auto n = static_cast<std::size_t>(s);
      const bool wanted = dem.cell(s).valid() && (scope == FieldScope::window || (flag_[n] & (heard | deferred)) != 0 || must_visit(dem, mixture, s));
      flag_[n] = !wanted ? quiet : visits_left > 0 ? visited : deferred;
      if (flag_[n] == visited) --visits_left;
      counters.cells_deferred += flag_[n] == deferred;
    }
  }
  for (int i = band; i < band_ && i < rows; ++i) {
    for (int j = 0; j < cols && visits_left > 0; ++j) {
      const int s = dem.slot(i, j);
      const auto n = static_cast<std::size_t>(s);
      if (flag_[n] != quiet || !dem.cell(s).valid()) continue;
      flag_[n] = visited;
      --visits_left;
    }
  }
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < cols; ++j) {
      const auto n = static_cast<std::size_t>(dem.slot(i, j));
      if (flag_[n] == visited) choose_candidates(dem, mixture, i, j, sites_[n]);
    }
  }
  // Each direction's messages follow its own order, so that one pass carries them across the window.
  for (int direction = 0; direction < directions; ++direction) {
    const bool forward = direction % 2 == 0;
    for (int a = 0; a < rows; ++a) {
      for (int b = 0; b < cols; ++b) {
        const int i = forward ? a : rows - 1 - a, j = forward ? b : cols - 1 - b;
        if ((flag_[static_cast<std::size_t>(dem.slot(i, j))] & visited) == 0) continue;
        send(dem, i, j, direction);
        ++counters.messages;
      }
    }
  }
  int changed = 0;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < cols; ++j) {
      const auto n = static_cast<std::size_t>(dem.slot(i, j));
      if (flag_[n] == quiet || !dem.cell(static_cast<int>(n)).valid()) continue;
      Site& site = sites_[n];
      const Logs logs = log_belief(dem, i, j, -1);
      std::size_t best = 0;
      for (std::size_t c = 1; c < candidates; ++c) {
        if (site.label[c] != none && logs[c] > logs[best]) best = c;
      }
      changed += site.best != site.label[best];
      site.best = site.label[best];
    }
  }
  return changed;
}

template <Limits limits>
bool LabelField<limits>::must_visit(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int slot) const {
  if (dem.touched(slot) || mixture.relabelled(slot)) return true;
  const Site& site = sites_[static_cast<std::size_t>(slot)];
  for (const LabelType label : site.label) {
    if (label != none && mixture.fresh(label)) return true;
  }
  return site.label[0] == none;
}

/// The planes of the regions in each block and those around it.
template <Limits limits>
void LabelField<limits>::find_planes_near_by(const Dem<limits>& dem, const PlaneMixture<limits>& mixture) {
  near_by_.fill({});
  for (int i = 0; i < dem.rows(); i += block_side) {
    for (int j = 0; j < dem.cols(); j += block_side) {
      Planes here;
      for (int k = 0; k < block_side * block_side; ++k) {
        const int s = dem.slot(i + k / block_side, j + k % block_side);
        const LabelType label = mixture.region_label(s);
        if (dem.cell(s).valid() && label != none) here[label] = true;
      }
      for (int a = i - block_side; a <= i + block_side; a += block_side) {
        for (int b = j - block_side; b <= j + block_side; b += block_side) {
          if (a >= 0 && b >= 0 && a < dem.rows() && b < dem.cols()) near_by_[block_of(dem, a, b)] |= here;
        }
      }
    }
  }
}

/// Node potentials: Student t with 6 degrees of freedom about the plane, the most likely three kept.
template <Limits limits>
void LabelField<limits>::choose_candidates(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int i, int j, Site& site) {
  const Cell& cell = dem.cell(dem.slot(i, j));
  const float x = dem.centroid_x_m(i, cell), y = dem.centroid_y_m(j, cell);
  const float cell_variance = noise_m2_ / cell.weight;
  Logs best{};
  std::array<LabelType, candidates> label{none, none, none};
  const Planes& near_by = near_by_[block_of(dem, i, j)];
  const bool nothing_near = near_by.none();
  for (int k = 0; k < limits.planes; ++k) {
    const Plane& plane = mixture.plane(k);
    if (!plane.alive() || !(nothing_near || near_by[static_cast<std::size_t>(k)])) continue;
    const float variance = plane.variance_m2 + cell_variance;
    const float residual = cell.height_m - plane.height_m(x, y);
    float u = 1.0f + residual * residual / (6.0f * variance);
    if (u > 1e5f) u = 1e5f;  // its seventh power must stay finite
    const float u3 = u * u * u;
    const float log_potential = -0.5f * log(variance * u3 * u3 * u);
    std::size_t place = candidates;
    while (place > 0 && (label[place - 1] == none || log_potential > best[place - 1])) --place;
    if (place == candidates) continue;
    for (std::size_t c = candidates - 1; c > place; --c) {
      label[c] = label[c - 1];
      best[c] = best[c - 1];
    }
    label[place] = static_cast<LabelType>(k);
    best[place] = log_potential;
  }
  site.label = label;
  for (std::size_t c = 0; c < candidates; ++c) {
    const float below = label[c] == none ? 0.0f : best[c] - best[0];
    site.node[c] = static_cast<std::int16_t>(round_to_int((below < -127.0f ? -127.0f : below) * node_scale));
  }
}

/// Log belief of each candidate from its node and the messages from all neighbours but the one at `except`.
template <Limits limits>
auto LabelField<limits>::log_belief(const Dem<limits>& dem, int i, int j, int except) const -> Logs {
  const Site& site = sites_[static_cast<std::size_t>(dem.slot(i, j))];
  Logs logs{};
  for (std::size_t c = 0; c < candidates; ++c) logs[c] = static_cast<float>(site.node[c]) * (1.0f / node_scale);
  for (int d = 0; d < directions; ++d) {
    if (d == except) continue;
    const auto n = static_cast<std::size_t>(d);
    const int g = dem.next_valid(i, j, step_i[n], step_j[n], settings_.link_reach);
    if (g == 0) continue;
    const Site& other = sites_[static_cast<std::size_t>(dem.slot(i + g * step_i[n], j + g * step_j[n]))];
    for (std::size_t c = 0; c < candidates; ++c) {
      for (std::size_t o = 0; o < candidates; ++o) {
        if (site.label[c] == other.label[o] && site.label[c] != none) {
          logs[c] += static_cast<float>(other.message[n ^ 1u][o]) * (1.0f / message_scale);
        }
      }
    }
  }
  return logs;
}

template <Limits limits>
auto LabelField<limits>::normalised(const Site& site, const Logs& logs) -> Logs {
  float top = logs[0];
  for (std::size_t c = 1; c < candidates; ++c) {
    if (site.label[c] != none && logs[c] > top) top = logs[c];
  }
  Logs p{};
  float sum = 0.0f;
  for (std::size_t c = 0; c < candidates; ++c) {
    p[c] = site.label[c] == none ? 0.0f : exp(logs[c] - top);
    sum += p[c];
  }
  for (float& value : p) value = sum > 0.0f ? value / sum : 0.0f;
  return p;
}

/// Potts message, normalised to 1 for labels that the sender rules out: m(l) = 1 + (exp(J/g) - 1) p(l), p the sender's belief
/// without what the receiver told it. At most exp(J).
template <Limits limits>
void LabelField<limits>::send(const Dem<limits>& dem, int i, int j, int direction) {
  const auto d = static_cast<std::size_t>(direction);
  const int g = dem.next_valid(i, j, step_i[d], step_j[d], settings_.link_reach);
  if (g == 0) return;
  Site& site = sites_[static_cast<std::size_t>(dem.slot(i, j))];
  const Logs p = normalised(site, log_belief(dem, i, j, direction));
  bool changed = false;
  for (std::size_t c = 0; c < candidates; ++c) {
    const float message = log(1.0f + boost_[static_cast<std::size_t>(g)] * p[c]);
    const auto rounded = static_cast<std::uint8_t>(round_to_int(message * message_scale));
    changed = changed || site.message[d][c] != rounded;
    site.message[d][c] = rounded;
  }
  if (changed) flag_[static_cast<std::size_t>(dem.slot(i + g * step_i[d], j + g * step_j[d]))] |= heard;
}

template <Limits limits>
auto LabelField<limits>::belief(const Dem<limits>& dem, int i, int j) const -> Belief {
  const Site& site = sites_[static_cast<std::size_t>(dem.slot(i, j))];
  return {site.label, normalised(site, log_belief(dem, i, j, -1))};
}

}  // namespace curbline
