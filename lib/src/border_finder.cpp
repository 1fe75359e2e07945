#include "curbline/border_finder.hpp"

namespace curbline {

float before_middle(const CrossedCell& cell) {
  const float far_share = cell.far_share < 0.0f ? 0.0f : cell.far_share > 1.0f ? 1.0f : cell.far_share;
  return 0.5f - far_share + cell.centroid;
}

}  // namespace curbline
