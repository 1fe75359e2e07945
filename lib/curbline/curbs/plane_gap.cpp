#include "curbline/curbs/plane_gap.hpp"

#include <algorithm>

namespace curbline {

float before_middle(const CrossedCell& cell) {
  return 0.5f - std::clamp(cell.far_share, 0.0f, 1.0f) + cell.centroid;
}

}  // namespace curbline
