// What a ray hits in a scene: the ground's planes, the vertical faces between them, and obstacles. About 1 us a ray: a
// grid over the ground plan lists the contents of each cell, and a ray visits the cells under it in order.
#pragma once

#include "simulator/boundary.hpp"
#include "simulator/scene.hpp"

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

namespace curbline::tools {

class RayCaster {
 public:
  static constexpr double nothing = std::numeric_limits<double>::infinity();

  explicit RayCaster(const Scene& scene);

  /// Moves the moving obstacles to their places at this time.
  void move_to(double time_s);

  /// Distance to the first surface, in units of the length of `direction`, or `nothing`.
  double cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  /// Height of the ground, or -infinity in the void.
  double ground_height_m(Point2 p) const;

 private:
  struct Cell {
    std::uint32_t first = 0;  // start of its run in items_: regions from the top down, then faces, then obstacles
    std::uint32_t regions = 0, faces = 0, obstacles = 0;
    bool plain = false;  // one region covers the whole cell
  };
  struct Face {
    Point2 from, to;
    SurfacePlane left, right;
  };
  struct Prism {
    Polygon outline;
    Point2 centre, offset;  // offset: displacement since time 0
    double radius_m = 0, bottom_m = 0, top_m = 0;
  };
  struct Ray {
    Eigen::Vector3d origin, direction;
    Point2 at(double t) const { return {origin.x() + t * direction.x(), origin.y() + t * direction.y()}; }
    double z(double t) const { return origin.z() + t * direction.z(); }
  };

  struct Contents;

  void lay_grid(const GroundPlan& plan);
  void fill_cell(Cell& cell, const Bounds& box, const Contents& contents);
  Prism prism_of(const Obstacle& obstacle, const GroundPlan& plan) const;
  const Cell* cell_at(Point2 p) const;
  int region_in(const Cell& cell, Point2 p) const;
  Share over_grid(const Ray& ray) const;
  double cast_outside(const Ray& ray, const Share& grid) const;
  double cast_inside(const Ray& ray, const Share& grid, double best) const;
  double cast_in_cell(const Ray& ray, const Cell& cell, double from, double to) const;
  static double hit_plane(const Ray& ray, const SurfacePlane& plane);
  static double hit_face(const Ray& ray, const Face& face);
  static double hit_prism(const Ray& ray, const Prism& prism);

  std::vector<GroundRegion> regions_;
  std::vector<Face> faces_;
  std::vector<Prism> fixed_;
  std::vector<Obstacle> moving_;
  std::vector<Prism> moved_;  // the prisms of moving_, in the same order
  Bounds bounds_;
  double cell_m_ = 0.5;
  int rows_ = 0, cols_ = 0;  // along x, along y
  double top_m_ = 0;         // the top of all that is fixed inside the grid
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> items_;
};

}  // namespace curbline::tools
