// A finished map, as returned by every method: the basis of the label and curb files, the pictures and the scores.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "map/polygon.hpp"

namespace curbline::tools {

struct Point3 {
  double x = 0, y = 0, z = 0;
};

/// A grid: cell (i, j) covers [x0 + i dx, x0 + (i+1) dx) x [y0 + j dy, y0 + (j+1) dy), metres.
struct Grid {
  double x0_m = 0, y0_m = 0;
  double dx_m = 0.1, dy_m = 0.1;
  int rows = 0;  ///< along x
  int cols = 0;  ///< along y
  std::size_t cells() const { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols); }
  std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(j);
  }
  double x_m(int i) const { return x0_m + (i + 0.5) * dx_m; }  ///< centre of a cell
  double y_m(int j) const { return y0_m + (j + 0.5) * dy_m; }
  Bounds bounds() const { return {x0_m, y0_m, x0_m + rows * dx_m, y0_m + cols * dy_m}; }
};

struct MapCell {
  double x_m = 0, y_m = 0;  ///< centroid of its points, or its centre
  double height_m = 0;      ///< mean height
  double variance_m2 = 0;   ///< of the cell's posterior
  int points = 0;           ///< 0: the cell is invalid and all other members are meaningless
  int label = -1;           ///< of the surface of its readings, which is one plane or several along a bend; -1: none
  double probability = 0;   ///< of the plane of its readings
  int ground = -1;          ///< label of the ground at its centre, if separate from that of the readings; otherwise -1
  int plane = -1;           ///< label of the plane of its readings, if separate from that of the surface; otherwise -1
};

inline int ground_of(const MapCell& cell) {
  return cell.ground >= 0 ? cell.ground : cell.label;
}

inline int plane_label_of(const MapCell& cell) {
  return cell.plane >= 0 ? cell.plane : cell.label;
}

/// z = z0 + sx x + sy y, in the grid's frame.
struct MapPlane {
  double z0_m = 0, sx = 0, sy = 0;
  double sd_m = 0;  ///< of cells about the plane
  int label = -1;
  double height_m(double x_m, double y_m) const { return z0_m + sx * x_m + sy * y_m; }
};

/// A straight piece of curb line. height_m: far side minus near side, as seen from the robot: positive is a step up.
struct MapCurb {
  double x0_m = 0, y0_m = 0, x1_m = 0, y1_m = 0;
  double height_m = 0, height_sd_m = 0, probability = 0;
  std::string kind{};  ///< step_up, step_down, crease, ramp_edge
  double position_sd_m = 0, face_width_m = 0;
  int id = 0;         ///< 0: none
  double rise_m = 0;  ///< change of height_m, which applies to the middle, from one end to the other
  double rise_sd_m = 0;
};

/// Whether its kind is a step, up or down, and not a crease or the edge of a ramp.
bool is_step(const MapCurb& curb);

/// That part of a curb line, with its own height.
MapCurb part_of(const MapCurb& curb, const Share& share);

struct Map {
  Grid grid;
  std::vector<MapCell> cells;  ///< grid.cells(), index grid.at(i, j)
  std::vector<MapPlane> planes;
  std::vector<MapCurb> curbs;
};

/// Where the robot is on a map. Heading: counterclockwise from x ahead.
struct RobotMarker {
  double x_m = 0, y_m = 0;
  double heading_rad = 0;
};

/// nullptr if the map has no plane with this label. O(planes).
const MapPlane* plane_of(const Map& map, int label);

/// Shifts the whole map.
void move(Map& map, const Point3& by);

}  // namespace curbline::tools
