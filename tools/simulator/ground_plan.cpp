#include "simulator/ground_plan.hpp"

#include <algorithm>
#include <limits>

namespace curbline::tools {
namespace {

constexpr double furthest_m = std::numeric_limits<double>::max();  // of the ground without bounds

Bounds about_region(const GroundRegion& region) {
  return region.outline.empty() ? Bounds{-furthest_m, -furthest_m, furthest_m, furthest_m} : bounds(region.outline);
}

}  // namespace

GroundPlan::GroundPlan(const std::vector<GroundRegion>& regions)
    : regions_(regions), tree_(tree_of(regions, about_region)) {}

int GroundPlan::region_at(Point2 p) const {
  for (const std::size_t k : near({p.x, p.y, p.x, p.y})) {
    if (regions_[k].holds(p)) return static_cast<int>(k);
  }
  return -1;
}

std::vector<std::size_t> GroundPlan::near(const Bounds& box) const {
  std::vector<std::size_t> found = tree_.overlapping(widened(box, touch_m));
  std::reverse(found.begin(), found.end());
  return found;
}

}  // namespace curbline::tools
