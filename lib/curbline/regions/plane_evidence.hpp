// The evidence that points lie on one plane, by which regions merge, and where planes are parted as bent ground is not.
// The precision of level and slopes is noise_m2 per noise variance, a standard deviation of 1 m and of 45 degrees:
// faces and obstacles are regions too.
#pragma once

#include <array>

#include "curbline/math.hpp"
#include "curbline/plane.hpp"

namespace curbline {

/// What the neighbouring cells on both sides of the border between two regions show: means over their pairs, from a
/// cell of the first region to that of the second.
struct BorderRise {
  float pairs = 0.0f;  ///< how many; 0: the regions lie apart, and nothing is known
  float dx_m = 0.0f, dy_m = 0.0f, rise_m = 0.0f;
};

/// How well one plane explains points; what depends on the prior alone is computed once.
class PlaneEvidence {
 public:
  PlaneEvidence() : PlaneEvidence(PlanePrior{}) {}
  explicit PlaneEvidence(const PlanePrior& prior);

  void set_common_share(float share) { prior_.common_share = share; }

  /// ln p(points | one plane) of the marginal likelihood, up to terms linear in the points that cancel between
  /// partitions of the same points. About 60 operations and 2 logarithms.
  float log_evidence(const PlaneMoments& moments) const;

  /// The share of a region in the posterior of a partition of the cells under a Dirichlet process with alpha = 1: its
  /// evidence times Gamma(cells).
  float score(const PlaneMoments& moments) const { return log_evidence(moments) + log_gamma_of(moments.cells); }

  /// By how much the posterior of the partition rises, in nats, when two regions of which the scores are known become
  /// `both`. The prior keeps ground that is bent from falling apart into the planes that follow it; it takes no part
  /// where two planes are parted as bent ground is not, see parted(), which wants border_of(), a BorderRise.
  template <typename BorderOf>
  float gain(const PlaneMoments& a, float score_a, const PlaneMoments& b, float score_b, const PlaneMoments& both,
             BorderOf&& border_of) const {
    const float prior = log_gamma_of(both.cells);
    const float gain = log_evidence(both) + prior - score_a - score_b;
    if (gain < 0.0f) return gain;
    const float by_evidence = gain - (prior - log_gamma_of(a.cells) - log_gamma_of(b.cells));
    return by_evidence < 0.0f && parted(a, b, border_of()) ? by_evidence : gain;
  }

  /// Two planes that follow one bent surface meet between their centroids, at an angle that its curvature makes over
  /// the distance between them. Parted are two of which one lies above the other by more than what the points of a
  /// place share of their noise (two standard deviations): at both centroids, by three standard deviations (a step); or
  /// on the mean of both, and the ground rises as much more than either plane from cell to cell along their border, by
  /// one standard deviation of that share and three of its own (a step between planes of different slope). Or which
  /// meet at an angle that is more by three standard deviations (a crease). About 250 operations.
  bool parted(const PlaneMoments& a, const PlaneMoments& b, const BorderRise& border) const;

 private:
  bool step_between(const Plane& first, const Plane& second, const BorderRise& border) const;
  bool rises(const Plane& first, const Plane& second, const BorderRise& border, float toward) const;
  bool crease_between(const Plane& first, const Plane& second) const;
  float log_gamma_of(float cells) const {
    const auto n = static_cast<unsigned>(cells);
    return n < log_gamma_.size() ? log_gamma_[n] : log_gamma(cells);
  }

  PlanePrior prior_;
  float constant_;                     ///< of every plane
  std::array<float, 64> log_gamma_{};  ///< of whole numbers
};

}  // namespace curbline
