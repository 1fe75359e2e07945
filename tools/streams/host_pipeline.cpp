#include "streams/host_pipeline.hpp"

#include <cmath>

#include "formats/bad_input.hpp"

namespace curbline::tools {
namespace {

template <Limits limits>
class PipelineOf final : public HostPipeline {
 public:
  explicit PipelineOf(const Settings& settings) {
    if (pipeline_.init(settings) != Status::ok) {
      throw BadInput(std::string("the pipeline refuses ") + bad_setting(settings, limits) +
                     "; expected settings of a robot's description");
    }
  }
  bool add_tilt(const TiltReading& reading) override { return pipeline_.add_tilt(reading); }
  bool add_pose(const Pose& pose) override { return pipeline_.add_pose(pose); }
  Status take(const ScanLine& line) override { return pipeline_.take(line); }
  Status take(const ScanLine& line, std::vector<Point>& out) override {
    const std::size_t before = out.size();
    const Status status = pipeline_.project(line, [&](const Point& p) { out.push_back(p); });
    if (status != Status::ok) return status;
    pipeline_.observe(std::span(out).subspan(before));
    pipeline_.infer();
    return status;
  }
  void observe(std::span<const Point> points) override { pipeline_.observe(points); }
  int settle() override { return pipeline_.settle(); }
  std::span<const Curb> curbs() const override { return pipeline_.curbs(); }
  const Counters& counters() const override { return pipeline_.counters(); }
  const TiltLatency& tilt_latency() const override { return pipeline_.tilt_latency(); }

  Grid grid() const override {
    const Dem<limits>& dem = pipeline_.dem();
    return {dem.origin_x_m(), dem.origin_y_m(), dem.cell_x_m(), dem.cell_y_m(), dem.rows(), dem.cols()};
  }

  Map map() const override {
    Map map;
    map.grid = grid();
    map.cells.resize(map.grid.cells());
    const Dem<limits>& dem = pipeline_.dem();
    for (int i = 0; i < dem.rows(); ++i) {
      for (int j = 0; j < dem.cols(); ++j) map.cells[map.grid.at(i, j)] = cell(i, j);
    }
    for (int label = 0; label < limits.planes; ++label) add_plane(map, label);
    map.curbs = map_curbs();
    return map;
  }

  std::vector<MapCurb> map_curbs() const override {
    std::vector<MapCurb> out;
    for (const Curb& curb : pipeline_.curbs()) {
      out.push_back(to_map_curb(curb));
      set_rise(curb, out.back());
    }
    return out;
  }

 private:
  /// From the slopes of both planes.
  void set_rise(const Curb& curb, MapCurb& out) const {
    if (!is_step(curb) || curb.near_label == no_label || curb.far_label == no_label) return;
    const Plane &near = pipeline_.plane(curb.near_label), &far = pipeline_.plane(curb.far_label);
    if (!near.alive() || !far.alive()) return;
    const float dx_m = curb.x1_m - curb.x0_m, dy_m = curb.y1_m - curb.y0_m;
    out.rise_m = (far.slope_x - near.slope_x) * dx_m + (far.slope_y - near.slope_y) * dy_m;
    out.rise_sd_m = std::sqrt(near.rise_variance_m2(dx_m, dy_m) + far.rise_variance_m2(dx_m, dy_m));
  }

  MapCell cell(int i, int j) const {
    const Dem<limits>& dem = pipeline_.dem();
    const Cell& from = dem.cell(dem.slot(i, j));
    if (!from.valid()) return {};
    const auto number = [](Label label) { return label == no_label ? -1 : int{label}; };
    const auto surface = [&](Label label) { return number(pipeline_.surface(label)); };
    MapCell to;
    to.x_m = dem.origin_x_m() + dem.centroid_x_m(i, from);
    to.y_m = dem.origin_y_m() + dem.centroid_y_m(j, from);
    to.height_m = from.height_m;
    to.variance_m2 = from.variance_m2(pipeline_.settings().segmentation.cell);
    to.points = static_cast<int>(from.points);
    to.label = surface(pipeline_.label(i, j));
    to.plane = number(pipeline_.label(i, j));
    to.probability = pipeline_.label_probability(i, j);
    to.ground = surface(pipeline_.ground_label(i, j));
    return to;
  }

  void add_plane(Map& map, int label) const {
    const Plane& plane = pipeline_.plane(label);
    if (!plane.alive()) return;
    const double at_corner = plane.height_m(0.0f, 0.0f);
    map.planes.push_back({at_corner - plane.slope_x * map.grid.x0_m - plane.slope_y * map.grid.y0_m, plane.slope_x,
                          plane.slope_y, std::sqrt(plane.variance_m2), label});
  }

  Pipeline<limits> pipeline_;
};

template <Limits limits>
bool fits(const Settings& settings) {
  return settings.window.rows <= limits.rows && settings.window.cols <= limits.cols &&
         settings.laser.beams <= limits.beams;
}

/// Reports errors in the settings as errors in the robot's file.
template <typename Make>
std::unique_ptr<HostPipeline> of_robot(const Robot& robot, Make&& make) {
  try {
    return make(pipeline_settings(robot));
  } catch (const BadInput& error) {
    throw BadInput(robot.file + ": " + error.what());
  }
}

}  // namespace

std::unique_ptr<HostPipeline> make_host_pipeline(const Settings& settings) {
  if (fits<board_limits>(settings)) return std::make_unique<PipelineOf<board_limits>>(settings);
  if (fits<wide_limits>(settings)) return std::make_unique<PipelineOf<wide_limits>>(settings);
  if (fits<largest_limits>(settings)) return std::make_unique<PipelineOf<largest_limits>>(settings);
  if (settings.laser.beams > largest_limits.beams) {
    throw BadInput("a laser of " + std::to_string(settings.laser.beams) + " beams; expected at most " +
                   std::to_string(largest_limits.beams));
  }
  throw BadInput("a window of " + std::to_string(settings.window.rows) + " x " + std::to_string(settings.window.cols) +
                 " cells; expected at most " + std::to_string(largest_limits.rows) + " x " +
                 std::to_string(largest_limits.cols));
}

std::unique_ptr<HostPipeline> make_host_pipeline(const Robot& robot) {
  return of_robot(robot, [](const Settings& settings) { return make_host_pipeline(settings); });
}

std::unique_ptr<HostPipeline> make_live_pipeline(const Robot& robot) {
  return of_robot(robot, [](const Settings& settings) -> std::unique_ptr<HostPipeline> {
    if (fits<live_limits>(settings)) return std::make_unique<PipelineOf<live_limits>>(settings);
    return make_host_pipeline(settings);
  });
}

MapCurb to_map_curb(const Curb& curb) {
  return {curb.x0_m,          curb.y0_m,         curb.x1_m,        curb.y1_m,
          curb.height_m,      curb.height_sd_m,  curb.probability, to_string(curb.kind),
          curb.position_sd_m, curb.face_width_m, curb.id};
}

}  // namespace curbline::tools
