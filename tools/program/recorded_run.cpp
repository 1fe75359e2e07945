#include "program/recorded_run.hpp"

#include <cmath>

#include "formats/file_exists.hpp"
#include "program/map_cloud.hpp"
#include "program/replay.hpp"

namespace curbline::tools {
namespace {

constexpr std::int64_t interval_ns = 100'000'000;  ///< between evaluations of what has been found

Robot robot_of(const std::string& dir) {
  Robot robot = read_robot(dir + "/robot.toml");
  if (file_exists(dir + "/poses.tum")) robot.pose.still = false;  // it drove, whatever robot.toml says
  return robot;
}

DriveLogs logs_of(const std::string& dir, const Robot& robot) {
  return {dir + "/scans.carmen", robot.tilt.fixed ? "" : dir + "/can.log", robot.pose.still ? "" : dir + "/poses.tum"};
}

/// Accumulates, look by look, what must be kept from a run.
class Record {
 public:
  Record(const Truth& truth, RecordedRun& run)
      : truth_start_ns_(std::llround(truth.start_time_s * 1e9)), detections_(truth), run_(run) {}

  void look(const Replay& replay) {
    const Map map = replay.pipeline().map();
    const std::vector<LabelledCell> cells = labelled_cells(map);
    for (const LabelledCell& cell : cells) run_.seen.add(cell.x_m, cell.y_m);
    const double time_s = static_cast<double>(replay.line().time_ns - truth_start_ns_) * 1e-9;
    const RobotMarker robot = replay.robot();
    detections_.observe(time_s, {robot.x_m, robot.y_m}, map.grid.bounds(), run_.seen, map.curbs);
    if (run_.drove && std::hypot(robot.x_m - last_.x_m, robot.y_m - last_.y_m) > 0.5 * map.grid.rows * map.grid.dx_m) {
      run_.found.windows.push_back(cells);
      last_ = robot;
    }
  }

  void finish(const Replay& replay) {
    look(replay);
    run_.remarks = replay.remarks();
    run_.map = replay.pipeline().map();
    run_.robot = replay.robot();
    run_.found.windows.push_back(labelled_cells(run_.map));
    run_.found.curbs = replay.all_curbs();
    run_.detections.assign(detections_.of_curbs().begin(), detections_.of_curbs().end());
  }

 private:
  std::int64_t truth_start_ns_;
  Detections detections_;
  RecordedRun& run_;
  RobotMarker last_;
};

}  // namespace

bool has_logs(const std::string& dir) {
  return file_exists(dir + "/scans.carmen") && file_exists(dir + "/robot.toml");
}

RecordedRun replay_recording(const std::string& dir, const Truth& truth) {
  const Robot robot = robot_of(dir);
  Replay replay(robot, logs_of(dir, robot));
  RecordedRun run;
  run.drove = !robot.pose.still;
  run.max_height_m = static_cast<double>(robot.window.max_height_m);
  Record record(truth, run);
  std::int64_t next_ns = INT64_MIN;
  while (replay.step()) {
    if (replay.line().time_ns < next_ns) continue;
    record.look(replay);
    next_ns = replay.line().time_ns + interval_ns;
  }
  replay.check_complete();
  record.finish(replay);
  const MountSettings& axis = robot.tilt.T_base_tilt;
  if (!run.drove) run.found.seen_from = Point2{static_cast<double>(axis.x_m), static_cast<double>(axis.y_m)};
  return run;
}

Map map_recording(const std::string& dir, const RecordedRun& run, MapMethod method) {
  const Robot robot = robot_of(dir);
  Replay replay(robot, logs_of(dir, robot));
  std::vector<Point> points;
  while (replay.step(&points)) continue;
  replay.check_complete();
  MapOptions options;
  options.method = method;
  return map_batch(cloud_of(points), run.map.grid, run.max_height_m, options);
}

}  // namespace curbline::tools
