// The curbs that the window of a robot that drives has left behind, in the state in which it left them.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "map/map.hpp"
#include "map/polygon.hpp"

namespace curbline::tools {

class LeftBehind {
 public:
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  explicit LeftBehind(const Grid& grid) : grid_(grid) {}

  /// The window is now there. Keeps the parts that it has left of the curbs last found. The pipeline may still have
  /// parts that were left before; those have been kept already. O(curbs).
  void follow(const Grid& grid, std::span<const MapCurb> last_found);

  const std::vector<MapCurb>& curbs() const { return curbs_; }

 private:
  void keep(const MapCurb& curb, double from, double to);

  Grid grid_;
  Bounds ahead_{-infinite, -infinite, infinite, infinite};  ///< curbs in it have not been kept
  std::vector<MapCurb> curbs_;
};

}  // namespace curbline::tools
