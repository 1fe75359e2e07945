// How far the ground of a side is off its plane: next to a curb, where a gutter or the camber of a road is too narrow
// or too weak for a plane of its own, and along it, where a plane holds more than one surface. Of a deviation away from
// the other side the share is taken that chance does not explain; one toward it may come from cells that mix both
// sides, and counts only as doubt about the plane. O(1).
#pragma once

#include <algorithm>
#include <array>

#include "curbline/borders/beside.hpp"
#include "curbline/math.hpp"
#include "curbline/plane.hpp"

namespace curbline {

/// The share of a deviation that chance does not explain: 1 less the variance that it would have by chance over its
/// square. (Of values scattered by a variance A about 0, found with an error of variance t^2, the best estimate is the
/// share A / (A + t^2) of what is found, and the square of what is found estimates A + t^2: empirical Bayes, Efron and
/// Morris 1973, for a single one.)
float share_beyond(float chance_m2, float found_m);

/// Height of the ground of a side above its plane, by cells a little farther from the border than those that may mix
/// both sides. A plane may hold more than one surface, parted by a crease too weak to be found, and deviate from both
/// all along a curb.
struct GroundAlong {
  /// Cells used, counted from the border's own: two of each border, whether it parts rows or columns.
  static constexpr std::array<int, 2> away_cells{2, 4};

  float above_m = 0.0f;      ///< the share of the cells' mean beyond two standard deviations of chance
  float share = 0.0f;        ///< that share; the same share of the plane's variance is replaced by variance_m2
  float variance_m2 = 0.0f;  ///< of the cells' mean as the ground at the border

  /// From the number of cells, of the borders that they lie behind, and the sum of their heights above the plane.
  /// Chance alone decides the share, and by chance cells err independently. In variance_m2 each border is one
  /// observation: what the cells behind one are off from the ground there, they are off alike. And where the plane is
  /// off the cells, the ground at the border may be as far off them as the plane is.
  static GroundAlong of(float cells, float borders, float above_m, const Plane& plane);
};

/// How much farther the ground of a side is from the other side than its plane is, as the mean of the borders; below 0
/// it is nearer.
struct Deviation {
  float away_m = 0.0f, variance_m2 = 0.0f;
  float shared_m2 = 0.0f;  ///< variance by what all borders err alike, in addition
  float borders = 0.0f;    ///< borders that show it

  /// The share of it that is the ground's.
  float share() const { return away_m > 0.0f ? share_beyond(variance_m2 + shared_m2, away_m) : 0.0f; }
  /// Variance of the side's height there, with the share that is taken of it. With none, the plane may be wrong by
  /// anything up to half of what exceeds two standard deviations, what chance makes of it.
  float height_variance_m2(float taken) const {
    return taken > 0.0f ? taken * (variance_m2 + shared_m2) : (1.0f / 12) * beyond_m2(4.0f);
  }
  /// Mean square, over of_borders borders, of a deviation by which the planes are farther apart than the ground is.
  float too_far_m2(float of_borders) const { return away_m < 0.0f ? borders / of_borders * beyond_m2(1.0f) : 0.0f; }

 private:
  float beyond_m2(float variances) const { return std::max(0.0f, square(away_m) - variances * variance_m2); }
};

/// The deviation of a side that begins `further_cells` beyond the borders, at the near end of a step down's shadow.
/// `away` is 1 if the other side is below, -1 if above. Each cell is one observation; besides, all borders err alike by
/// half of common_m2, the variance that points of one place share, and their nearer and their farther cells, each on
/// their own, by the scan lines along the borders, with the variance line_m2 over the points of a cell. 0 without
/// borders.
Deviation deviation(const Beside& beside, const Plane& plane, float away, float further_cells, float common_m2,
                    float line_m2);

}  // namespace curbline
