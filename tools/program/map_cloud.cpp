#include "program/map_cloud.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "map/median.hpp"
#include "peers/peers.hpp"
#include "program/map_window.hpp"
#include "program/mistimed_lines.hpp"
#include "streams/host_pipeline.hpp"

namespace curbline::tools {

namespace {

/// Narrow strips at the window's edge are recognised by what lies beyond it, so a margin is mapped too.
void widen(WindowSettings& window) {
  window.fixed = true;
  window.origin_x_m -= static_cast<float>(margin_cells) * window.cell_x_m;
  window.origin_y_m -= static_cast<float>(margin_cells) * window.cell_y_m;
  window.rows += 2 * margin_cells;
  window.cols += 2 * margin_cells;
}

/// Whole kilometres to the window and to the median height of the cloud: relative to these, float resolves the points.
Point3 whole_kilometres(std::span<const Point3> cloud, const MapOptions& options) {
  const auto whole = [](double metres) { return 1000 * std::round(metres / 1000); };
  std::vector<double> heights;
  for (const Point3& p : cloud) heights.push_back(p.z);
  const double z = heights.empty() ? 0 : whole(median(std::move(heights)));
  return options.fixed() ? Point3{whole(options.origin[0]), whole(options.origin[1]), z} : Point3{0, 0, z};
}

/// Height of the ground around the origin: the median of the lowest points in squares of a quarter metre, within 3 m
/// or, if nothing is seen that near, one and a half times the distance of the nearest point. Nothing if that is beyond
/// a laser's reach.
std::optional<double> ground_about_origin_m(std::span<const Point3> cloud) {
  constexpr double square_m = 0.25, around_m = 3, furthest_m = 30;
  const auto away_m = [](const Point3& p) { return std::hypot(p.x, p.y); };
  const auto nearest = std::ranges::min_element(cloud, {}, away_m);
  if (nearest == cloud.end() || away_m(*nearest) > furthest_m) return std::nullopt;
  const double reach_m = std::max(around_m, 1.5 * away_m(*nearest));
  std::map<std::array<double, 2>, double> lowest;
  for (const Point3& p : cloud) {
    if (away_m(p) > reach_m) continue;
    const auto [square, first] = lowest.try_emplace({std::floor(p.x / square_m), std::floor(p.y / square_m)}, p.z);
    if (p.z < square->second) square->second = p.z;
  }
  std::vector<double> heights;
  for (const auto& [square, height] : lowest) heights.push_back(height);
  return median(std::move(heights));
}

/// Height of the laser above the origin. In the frame of a laser it is 0. In that of a robot's base, recognised by
/// ground that is closer to the origin's height than to that of the ground below a pavement robot's laser, it is the
/// height at which such a robot carries its laser. If neither is possible, nothing is known; a laser below all ground
/// stands for that.
double laser_above_origin_m(std::span<const Point3> cloud) {
  constexpr double carried_m = 1, unknown_m = -100;
  const std::optional<double> ground_m = ground_about_origin_m(cloud);
  if (!ground_m || *ground_m > 0.5 * carried_m) return unknown_m;
  return *ground_m < -0.5 * carried_m ? 0 : carried_m;
}

/// Position of the laser relative to `place`. A pipeline's mount reaches 100 m at most; beyond that only the direction
/// is kept.
MountSettings laser_seen_from(const Point3& place, double above_origin_m) {
  constexpr double furthest_m = 100;
  const Point3 way{-place.x, -place.y, above_origin_m - place.z};
  const double away_m = std::hypot(way.x, way.y, way.z);
  const double share = away_m > furthest_m ? furthest_m / away_m : 1;
  return {.x_m = static_cast<float>(share * way.x),
          .y_m = static_cast<float>(share * way.y),
          .z_m = static_cast<float>(share * way.z)};
}

/// Moves a coordinate at least a thousandth of a cell away from the borders of the cell that it has in double
/// precision, as in the paper's steps. A cloud in millimetres has points exactly on the border of two cells, and the
/// pipeline's floats would put them on either side. Cells begin at `first_m`. With cells of 10 cm, floats are off by a
/// third of that thousandth at a distance of 500 m.
double within_cell(double at_m, double first_m, double side_m) {
  constexpr double rim = 1e-3;
  const double cells = (at_m - first_m) / side_m, cell = std::floor(cells);
  return first_m + side_m * std::clamp(cells, cell + rim, cell + 1 - rim);
}

/// Maps with the pipeline, with `place` as the origin of its map.
Map map_about(const Point3& place, std::span<const Point3> cloud, MapOptions options) {
  if (options.fixed()) options.origin = {options.origin[0] - place.x, options.origin[1] - place.y};
  if (options.max_height_m) *options.max_height_m -= place.z;
  Settings settings;
  settings.tilt.T_base_tilt = laser_seen_from(place, laser_above_origin_m(cloud));
  apply_window(options, settings.window);
  const Grid grid = asked_grid(options, settings.window);
  widen(settings.window);
  // Nothing is known about the sensor: every point gets the variance that the prior expects.
  const PlanePrior& prior = settings.planes.prior;
  const float variance_m2 = prior.noise_m2 - prior.texture_m2;
  const double first_x_m = grid.x0_m + place.x, first_y_m = grid.y0_m + place.y;
  const std::vector<double> lift_m = mistimed_lift_m(cloud);
  std::vector<Point> points;
  points.reserve(cloud.size());
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    const Point3& p = cloud[k];
    points.push_back({static_cast<float>(within_cell(p.x, first_x_m, grid.dx_m) - place.x),
                      static_cast<float>(within_cell(p.y, first_y_m, grid.dy_m) - place.y),
                      static_cast<float>(p.z - lift_m[k] - place.z), variance_m2});
  }
  const auto pipeline = make_host_pipeline(settings);
  pipeline->observe(points);
  pipeline->settle();
  Map map = crop(pipeline->map(), grid);
  move(map, place);
  return map;
}

}  // namespace

Map map_cloud(std::span<const Point3> cloud, const MapOptions& options) {
  if (options.method == MapMethod::curbline) return map_about(whole_kilometres(cloud, options), cloud, options);
  Settings settings;
  apply_window(options, settings.window);
  return map_batch(cloud, asked_grid(options, settings.window), static_cast<double>(settings.window.max_height_m),
                   options);
}

Map map_batch(std::span<const Point3> cloud, const Grid& grid, double max_height_m, const MapOptions& options) {
  if (options.method == MapMethod::canny || options.method == MapMethod::gradient) {
    const bool canny = options.method == MapMethod::canny;
    return peers::map_cloud(cloud, grid, max_height_m, canny ? peers::Method::canny : peers::Method::gradient);
  }
  reference::Options out;
  out.method = options.method == MapMethod::segment ? reference::Method::segment
               : options.method == MapMethod::em    ? reference::Method::em
                                                    : reference::Method::crf_em;
  out.edge = options.edge;
  out.segment_scale = options.segment_scale;
  out.max_height_m = max_height_m;
  return reference::map_cloud(cloud, grid, out);
}

std::vector<Point3> cloud_of(std::span<const Point> points) {
  std::vector<Point3> cloud;
  cloud.reserve(points.size());
  for (const Point& p : points)
    cloud.push_back({static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(p.z_m)});
  return cloud;
}

}  // namespace curbline::tools
