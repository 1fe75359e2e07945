#include "simulator/truth.hpp"

#include "simulator/boundary.hpp"
#include "simulator/face.hpp"
#include "simulator/ground_plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace curbline::tools {
namespace {

constexpr double step_m = 0.01;  // less at both ends is a crease
constexpr double margin_m = 10;

bool same(const SurfacePlane& a, const SurfacePlane& b) {
  const auto near = [](double x, double y) { return std::abs(x - y) < 1e-9; };
  return near(a.z0_m, b.z0_m) && near(a.sx, b.sx) && near(a.sy, b.sy) && near(a.camber.bend_1_m, b.camber.bend_1_m) &&
         (a.camber.bend_1_m == 0 ||
          (near(a.camber.away_m(b.camber.crown), 0) &&
           near(a.camber.across.x * b.camber.across.y, a.camber.across.y * b.camber.across.x)));
}

int plane_index(const GroundRegion& region, std::vector<TruthPlane>& planes) {
  const auto found =
      std::find_if(planes.begin(), planes.end(), [&](const TruthPlane& p) { return same(p.plane, region.plane); });
  const auto index = static_cast<int>(found - planes.begin());
  if (found == planes.end()) {
    planes.push_back({region.name, region.plane});
  }
  return index;
}

TruthCurb curb_between(Point2 from, Point2 to, const SurfacePlane& left, const SurfacePlane& right) {
  TruthCurb curb;
  curb.from = from;
  curb.to = to;
  curb.from_step_m = left.height_m(from) - right.height_m(from);
  curb.to_step_m = left.height_m(to) - right.height_m(to);
  const Point2 middle = 0.5 * (from + to);
  curb.left_z_m = left.height_m(middle);
  curb.right_z_m = right.height_m(middle);
  curb.height_m = std::abs(curb.left_z_m - curb.right_z_m);
  curb.kind = std::max(std::abs(curb.from_step_m), std::abs(curb.to_step_m)) < step_m ? "crease" : "step";
  return curb;
}

/// One curb, or two if the step changes its sign along its length.
void append_curbs(const Boundary& piece, const SurfacePlane& left, const SurfacePlane& right,
                  std::vector<TruthCurb>& out) {
  const TruthCurb whole = curb_between(piece.from, piece.to, left, right);
  if (whole.from_step_m * whole.to_step_m >= 0) {
    out.push_back(whole);
    return;
  }
  const double t = whole.from_step_m / (whole.from_step_m - whole.to_step_m);
  const Point2 level = piece.from + t * (piece.to - piece.from);
  out.push_back(curb_between(piece.from, level, left, right));
  out.push_back(curb_between(level, piece.to, left, right));
}

/// Does an obstacle reach down to the ground somewhere? Below one that hangs, such as the top of a table, the laser
/// sees ground.
bool stands(const Obstacle& obstacle, const GroundPlan& plan) {
  return !obstacle.base_m || std::any_of(obstacle.outline.begin(), obstacle.outline.end(), [&](Point2 p) {
    const int region = plan.region_at(p);
    return region >= 0 &&
           *obstacle.base_m < plan.regions()[static_cast<std::size_t>(region)].plane.height_m(p) + touch_m;
  });
}

/// A rectangle around everything that has an outline.
Polygon about_all(const Truth& truth) {
  Polygon corners{{0, 0}};
  for (const TruthRegion& region : truth.regions) {
    corners.insert(corners.end(), region.outline.begin(), region.outline.end());
  }
  const Bounds all = bounds(corners);
  return rectangle({all.x0 - margin_m, all.y0 - margin_m}, {all.x1 + margin_m, all.y1 + margin_m});
}

}  // namespace

int Truth::region_at(double x_m, double y_m) const {
  for (std::size_t i = regions.size(); i-- > 0;) {
    if (regions[i].outline.empty() || contains(regions[i].outline, {x_m, y_m})) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

int Truth::plane_at(double x_m, double y_m) const {
  const int region = region_at(x_m, y_m);
  if (region < 0) return -1;
  const TruthRegion& here = regions[static_cast<std::size_t>(region)];
  return here.face ? -1 : here.plane;
}

double Truth::terrain_height(double x_m, double y_m) const {
  const int region = region_at(x_m, y_m);
  if (region < 0) return std::numeric_limits<double>::quiet_NaN();
  const int plane = regions[static_cast<std::size_t>(region)].plane;
  return planes[static_cast<std::size_t>(plane)].plane.height_m({x_m, y_m});
}

bool Truth::obstacle_at(double x_m, double y_m) const {
  return std::any_of(obstacles.begin(), obstacles.end(), [&](const TruthObstacle& obstacle) {
    return contains(obstacle.outline, {x_m, y_m});
  });
}

Truth make_truth(const Scene& scene, double start_time_s) {
  Truth truth;
  truth.start_time_s = start_time_s;
  const std::vector<Boundary> pieces = visible_boundaries(scene.regions);
  const std::vector<bool> faces = faces_of(scene.regions, pieces);
  for (std::size_t r = 0; r < scene.regions.size(); ++r) {
    const GroundRegion& region = scene.regions[r];
    truth.regions.push_back({region.name, region.outline, plane_index(region, truth.planes), faces[r]});
  }
  for (const Boundary& piece : across_faces(scene.regions, pieces, faces)) {
    if (piece.left < 0 || piece.right < 0) {
      continue;
    }
    const SurfacePlane& left = scene.regions[static_cast<std::size_t>(piece.left)].plane;
    const SurfacePlane& right = scene.regions[static_cast<std::size_t>(piece.right)].plane;
    if (!same(left, right)) {
      append_curbs(piece, left, right, truth.curbs);
    }
  }
  const GroundPlan plan(scene.regions);
  for (const Obstacle& obstacle : scene.obstacles) {
    if (!obstacle.moves() && stands(obstacle, plan)) {
      truth.obstacles.push_back({obstacle.name, obstacle.outline});
    }
  }
  return truth;
}

std::vector<Polygon> drawn_regions(const Truth& truth) {
  std::vector<Polygon> out;
  for (auto region = truth.regions.rbegin(); region != truth.regions.rend(); ++region) {
    out.push_back(region->outline.empty() ? about_all(truth) : region->outline);
  }
  return out;
}

}  // namespace curbline::tools
