#include "curbline/map_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "curbline/host_pipeline.hpp"
#include "peers/peers.hpp"

namespace curbline::tools {

namespace {

/// What lies beyond the window's edge tells what a strip within is: that much of it is mapped too.
void widen(WindowSettings& window) {
  window.fixed = true;
  window.origin_x_m -= static_cast<float>(margin_cells) * window.cell_x_m;
  window.origin_y_m -= static_cast<float>(margin_cells) * window.cell_y_m;
  window.rows += 2 * margin_cells;
  window.cols += 2 * margin_cells;
}

/// Whole kilometres to the window and to most of the cloud's heights: from there on float tells points apart.
Point3 whole_kilometres(std::span<const Point3> cloud, const MapOptions& options) {
  const auto whole = [](double metres) { return 1000 * std::round(metres / 1000); };
  std::vector<double> heights;
  for (const Point3& p : cloud) heights.push_back(p.z);
  const auto middle = heights.begin() + std::ssize(heights) / 2;
  std::nth_element(heights.begin(), middle, heights.end());
  const double z = heights.empty() ? 0 : whole(*middle);
  return options.fixed() ? Point3{whole(options.origin[0]), whole(options.origin[1]), z} : Point3{0, 0, z};
}

/// Where the origin lies, as seen from `place`; a pipeline's mount reaches 100 m at most, which leaves its direction.
MountSettings origin_seen_from(const Point3& place) {
  constexpr double furthest_m = 100;
  const double away_m = std::hypot(place.x, place.y, place.z);
  const double share = away_m > furthest_m ? -furthest_m / away_m : -1;
  return {.x_m = static_cast<float>(share * place.x),
          .y_m = static_cast<float>(share * place.y),
          .z_m = static_cast<float>(share * place.z)};
}

/// By the pipeline, with `place` as its map's origin.
Map map_about(const Point3& place, std::span<const Point3> cloud, MapOptions options) {
  if (options.fixed()) options.origin = {options.origin[0] - place.x, options.origin[1] - place.y};
  if (options.max_height_m) *options.max_height_m -= place.z;
  Settings settings;
  settings.tilt.T_base_tilt = origin_seen_from(place);
  apply_window(options, settings.window);
  const Grid grid = asked_grid(options, settings.window);
  widen(settings.window);
  // Nothing is known of the sensor: every point has the variance that the prior expects.
  const PlanePrior& prior = settings.planes.prior;
  const float variance_m2 = prior.noise_m2 - prior.texture_m2;
  std::vector<Point> points;
  points.reserve(cloud.size());
  for (const Point3& p : cloud) {
    points.push_back({static_cast<float>(p.x - place.x), static_cast<float>(p.y - place.y),
                      static_cast<float>(p.z - place.z), variance_m2});
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
