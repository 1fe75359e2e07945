// The regions of a scene's ground, for finding which of them lies on top at a place.
#pragma once

#include <cstddef>
#include <vector>

#include "simulator/bounds_tree.hpp"
#include "simulator/scene.hpp"

namespace curbline::tools {

inline constexpr double touch_m = 1e-6;  ///< closer corners are the same

class GroundPlan {
 public:
  /// `regions` must outlive it.
  explicit GroundPlan(const std::vector<GroundRegion>& regions);

  const std::vector<GroundRegion>& regions() const { return regions_; }

  /// Index of the topmost region there, or -1 in the void.
  int region_at(Point2 p) const;

  /// The regions that may have a part in the box, the topmost first.
  std::vector<std::size_t> near(const Bounds& box) const;

 private:
  const std::vector<GroundRegion>& regions_;
  BoundsTree tree_;
};

}  // namespace curbline::tools
