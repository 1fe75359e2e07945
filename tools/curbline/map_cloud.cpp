#include "curbline/map_cloud.hpp"

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

}  // namespace

Map map_cloud(std::span<const Point3> cloud, const MapOptions& options) {
  Settings settings;
  apply_window(options, settings.window);
  const Grid grid = asked_grid(options, settings.window);
  if (options.method != MapMethod::curbline)
    return map_batch(cloud, grid, static_cast<double>(settings.window.max_height_m), options);
  widen(settings.window);
  // Nothing is known of the sensor: every point has the variance that the prior expects.
  const PlanePrior& prior = settings.planes.prior;
  const float variance_m2 = prior.noise_m2 - prior.texture_m2;
  std::vector<Point> points;
  points.reserve(cloud.size());
  for (const Point3& p : cloud) {
    points.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), variance_m2});
  }
  const auto pipeline = make_host_pipeline(settings);
  pipeline->observe(points);
  pipeline->settle();
  return crop(pipeline->map(), grid);
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
  for (const Point& p : points) cloud.push_back({static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(p.z_m)});
  return cloud;
}

}  // namespace curbline::tools
