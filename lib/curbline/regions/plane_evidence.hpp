// The evidence that points lie on one plane, by which regions merge, and the test whether two planes are parted by more
// than bent ground explains. The prior of level and slopes has a standard deviation of 1 m and of 45 degrees (precision
// noise_m2, in units of the noise): faces and obstacles are regions too.
#pragma once

#include <array>

#include "curbline/math.hpp"
#include "curbline/plane.hpp"

namespace curbline {

/// Means over pairs of adjacent cells along the border of two regions, from the cell of the first to that of the
/// second.
struct BorderRise {
  float pairs = 0.0f;  ///< their number; 0 if the regions do not touch
  float dx_m = 0.0f, dy_m = 0.0f, rise_m = 0.0f;
};

/// How well one plane explains points; terms that depend on the prior alone are computed once.
class PlaneEvidence {
 public:
  PlaneEvidence() : PlaneEvidence(PlanePrior{}) {}
  explicit PlaneEvidence(const PlanePrior& prior);

  void set_common_share(float share) { prior_.common_share = share; }

  /// ln p(points | one plane) of the marginal likelihood, up to terms linear in the points that cancel between
  /// partitions of the same points. About 60 operations and 2 logarithms.
  float log_evidence(const PlaneMoments& moments) const;

  /// Log of a region's factor in the posterior of a partition of the cells under a Dirichlet process with alpha = 1:
  /// its evidence times Gamma(cells).
  float score(const PlaneMoments& moments) const { return log_evidence(moments) + log_gamma_of(moments.cells); }

  /// By how much the log posterior of the partition rises, in nats, when two regions with known scores become `both`.
  /// The prior keeps bent ground from falling apart into the planes that follow it; it is left out where two planes are
  /// parted(), for which border_of() returns the BorderRise.
  template <typename BorderOf>
  float gain(const PlaneMoments& a, float score_a, const PlaneMoments& b, float score_b, const PlaneMoments& both,
             BorderOf&& border_of) const {
    const float prior = log_gamma_of(both.cells);
    const float gain = log_evidence(both) + prior - score_a - score_b;
    if (gain < 0.0f) return gain;
    const float by_evidence = gain - (prior - log_gamma_of(a.cells) - log_gamma_of(b.cells));
    return by_evidence < 0.0f && parted(a, b, border_of()) ? by_evidence : gain;
  }

  /// Are two planes parted by more than bent ground explains? Planes along one bent surface meet between their
  /// centroids, at the angle that its curvature makes over the distance between them. With s, the standard deviation of
  /// the noise that points of one place share, they are parted
  ///   - by a step, if one lies above the other at both centroids, by 2 s and by three standard deviations of the
  ///     difference; or if it does in the mean of both, by 2 s, and the cells along the border jump the same way,
  ///     beyond the planes' slopes, by s and by three standard deviations of that jump;
  ///   - by a crease, if they meet at an angle that is larger by three standard deviations.
  /// About 250 operations.
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
