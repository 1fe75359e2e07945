// One cell of the label field, and the arithmetic of its beliefs: candidate labels, their node potentials and the Potts
// messages sent last (paper, section III-D). LabelField decides which cells send. Sums are in integer fractions of a
// nat, so that a message can be subtracted again exactly.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "curbline/grid.hpp"
#include "curbline/math.hpp"

namespace curbline {

/// A cell keeps this many labels, the most likely; all others count as impossible for it.
inline constexpr int label_candidates = 3;

/// Posterior of a cell's label.
struct Belief {
  std::array<Label, label_candidates> label;        ///< no_label where there are fewer
  std::array<float, label_candidates> probability;  ///< sums to 1

  /// Probability of one label, 0 if it is no candidate.
  float of(Label wanted) const {
    float found = 0.0f;
    for (std::size_t c = 0; c < label.size(); ++c) {
      if (label[c] == wanted) found = probability[c];
    }
    return found;
  }
};

struct LabelSite {
  // Messages are bytes in 1/32 nat, node potentials in 1/256 nat below the best: as exact as needed, even half
  // precision changes nothing.
  static constexpr int message_scale = 32, node_scale = 256;

  using Labels = std::array<Label, label_candidates>;
  using Message = std::array<std::uint8_t, label_candidates>;  ///< for each candidate of the sender
  using Heard = std::array<std::int16_t, label_candidates>;  ///< a sum of messages, for each candidate of the receiver
  using Probabilities = std::array<float, label_candidates>;
  /// Potts factor exp(J / g) over a gap of g cells.
  struct Coupling {
    float boost = 0.0f;        ///< exp(J / g) - 1
    std::uint8_t loudest = 0;  ///< J / g, the message of a cell that is certain
  };

  Labels label{no_label, no_label, no_label};
  Label best = no_label;
  std::array<std::int16_t, label_candidates - 1> node{};  ///< log potential of each candidate but the first, whose is 0
  std::array<Message, directions> sent{};                 ///< last message to the neighbour in each direction

  static Coupling coupling(float nats) {
    return {exp(nats) - 1.0f, static_cast<std::uint8_t>(round_to_int(nats * float{message_scale}))};
  }

  /// Labels in order of likelihood, the best first. `doubt` is 1 / potential^2, as it is cheaper to compare: a
  /// logarithm is taken of those alone that are kept.
  struct Candidates {
    Labels label{no_label, no_label, no_label};
    std::array<float, label_candidates> doubt{};

    void consider(Label other, float other_doubt);
  };

  /// Only one label is possible, or none.
  bool decided() const { return label[1] == no_label; }
  /// Replaces or reorders the candidates; messages stay with their labels.
  void set_labels(const Labels& labels);
  /// The same, with node potentials from their doubts; flat ones where the ground is covered.
  void set_candidates(const Candidates& candidates, bool covered);
  /// Adds a neighbour's message, or its change, to `sum` (sign 1), or subtracts it (-1), for the candidates that both
  /// have.
  template <typename Said>
  void hear(const Labels& others, const Said& said, int sign, Heard& sum) const;
  /// The belief, from node potentials and messages heard.
  Probabilities probabilities(const Heard& heard) const;
  /// The message of a cell with belief p, without the receiver's own message; normalised to 1 for labels that it rules
  /// out: m(l) = 1 + (exp(J / g) - 1) p(l).
  static Message message(const Probabilities& p, const Coupling& coupling);
  /// The most likely candidate.
  Label most_likely(const Heard& heard) const;

 private:
  using Nats = std::array<std::int32_t, label_candidates>;  ///< in 1 / node_scale nat
  Nats log_belief(const Heard& heard) const;
};

inline void LabelSite::Candidates::consider(Label other, float other_doubt) {
  const auto follows = [&](std::size_t c) { return label[c] == no_label || other_doubt < doubt[c]; };
  std::size_t rank = label.size() - 1;
  if (!follows(rank)) return;
  for (; rank > 0 && follows(rank - 1); --rank) {
    label[rank] = label[rank - 1];
    doubt[rank] = doubt[rank - 1];
  }
  label[rank] = other;
  doubt[rank] = other_doubt;
}

inline void LabelSite::set_candidates(const Candidates& candidates, bool covered) {
  set_labels(candidates.label);
  node.fill(0);
  if (covered) return;
  for (std::size_t c = 1; c < label.size() && label[c] != no_label; ++c) {
    const float below = -0.5f * log(candidates.doubt[c] / candidates.doubt[0]);
    node[c - 1] = static_cast<std::int16_t>(round_to_int((below < -127.0f ? -127.0f : below) * float{node_scale}));
  }
}

inline void LabelSite::set_labels(const Labels& labels) {
  if (labels == label) return;
  for (Message& message : sent) {
    const Message before = message;
    for (std::size_t c = 0; c < label.size(); ++c) {
      message[c] = 0;
      for (std::size_t o = 0; o < label.size(); ++o) {
        if (labels[c] != no_label && label[o] == labels[c]) message[c] = before[o];
      }
    }
  }
  label = labels;
}

template <typename Said>
void LabelSite::hear(const Labels& others, const Said& said, int sign, Heard& sum) const {
  for (std::size_t c = 0; c < label.size() && label[c] != no_label; ++c) {
    for (std::size_t o = 0; o < others.size(); ++o) {
      if (label[c] == others[o]) sum[c] = static_cast<std::int16_t>(sum[c] + sign * said[o]);
    }
  }
}

inline auto LabelSite::log_belief(const Heard& heard) const -> Nats {
  Nats logs;
  for (std::size_t c = 0; c < label.size(); ++c) logs[c] = heard[c] * (node_scale / message_scale);
  for (std::size_t c = 0; c < node.size(); ++c) logs[c + 1] += node[c];
  return logs;
}

inline auto LabelSite::probabilities(const Heard& heard) const -> Probabilities {
  constexpr std::int32_t nothing = -8 * node_scale;  // lower ones change no message
  const Nats logs = log_belief(heard);
  std::int32_t top = logs[0];
  for (std::size_t c = 1; c < label.size() && label[c] != no_label; ++c) {
    if (logs[c] > top) top = logs[c];
  }
  Probabilities p{};
  float sum = 0.0f;
  for (std::size_t c = 0; c < label.size() && label[c] != no_label; ++c) {
    const std::int32_t below = logs[c] - top;
    if (below < nothing) continue;
    p[c] = below == 0 ? 1.0f : exp(static_cast<float>(below) * (1.0f / node_scale));
    sum += p[c];
  }
  if (!(sum > 1.0f)) return p;
  for (float& value : p) value /= sum;
  return p;
}

inline auto LabelSite::message(const Probabilities& p, const Coupling& coupling) -> Message {
  Message logs;
  for (std::size_t c = 0; c < logs.size(); ++c) {
    logs[c] = p[c] == 0.0f ? std::uint8_t{0}
              : p[c] == 1.0f
                  ? coupling.loudest
                  : static_cast<std::uint8_t>(round_to_int(log(1.0f + coupling.boost * p[c]) * float{message_scale}));
  }
  return logs;
}

inline auto LabelSite::most_likely(const Heard& heard) const -> Label {
  if (decided()) return label[0];
  const Nats logs = log_belief(heard);
  std::size_t best_one = 0;
  for (std::size_t c = 1; c < label.size() && label[c] != no_label; ++c) {
    if (logs[c] > logs[best_one]) best_one = c;
  }
  return label[best_one];
}

}  // namespace curbline
