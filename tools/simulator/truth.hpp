// The truth about a simulated scene, in the map frame of the simulated data, for scoring. Written as truth.json beside
// the data.
#pragma once

#include "simulator/scene.hpp"

#include <ostream>
#include <string>
#include <vector>

namespace curbline::tools {

struct TruthPlane {
  std::string name;  ///< of the first region in it
  SurfacePlane plane;
};

/// As drawn, including parts that later regions cover. Regions of one plane share its index.
struct TruthRegion {
  std::string name;
  Polygon outline;  ///< empty: everywhere
  int plane = 0;
  bool face = false;  ///< of a step: no ground (face.hpp)
};

/// A straight piece of the line between two planes; left and right as seen when going from `from` to `to`. Where the
/// face of a step leans, the line is its middle, at which both planes are compared.
struct TruthCurb {
  Point2 from, to;
  double from_step_m = 0, to_step_m = 0;  ///< left minus right at each end; the sign does not change along its length
  double left_z_m = 0, right_z_m = 0;     ///< in the middle
  double height_m = 0;                    ///< mean step, >= 0
  std::string kind;                       ///< step: 1 cm or more at one end at least; crease: less
};

/// An obstacle that stands on the ground and does not move, so that what is below is never visible.
struct TruthObstacle {
  std::string name;
  Polygon outline;
};

struct Truth {
  double start_time_s = 0;
  std::vector<TruthPlane> planes;
  std::vector<TruthRegion> regions;  ///< a later one covers an earlier one
  std::vector<TruthCurb> curbs;
  std::vector<TruthObstacle> obstacles;

  int region_at(double x_m, double y_m) const;          ///< index, or -1 in the void
  int plane_at(double x_m, double y_m) const;           ///< index of the ground's, or -1 in the void and on a face
  double terrain_height(double x_m, double y_m) const;  ///< metres, on a face too; NaN in the void
  bool obstacle_at(double x_m, double y_m) const;
};

/// Makes the truth of a scene in its map frame (in_map_frame).
Truth make_truth(const Scene& scene, double start_time_s);

void write_truth(std::ostream& out, const Truth& truth);

/// The polygons for regions.gt, topmost first: a point belongs to the first that contains it. An unbounded region is
/// drawn 10 m beyond all others.
std::vector<Polygon> drawn_regions(const Truth& truth);

/// Reads DIR/truth.json. Throws BadInput if it is missing or not in the format that write_truth() writes.
Truth read_truth(const std::string& dir);

}  // namespace curbline::tools
