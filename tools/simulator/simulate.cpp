#include "simulator/simulate.hpp"

#include "formats/atomic_file.hpp"
#include "formats/can_log.hpp"
#include "formats/carmen.hpp"
#include "formats/regions.hpp"
#include "formats/trajectory.hpp"
#include "robot/robot.hpp"
#include "simulator/simulation.hpp"
#include "simulator/truth.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <list>

namespace curbline::tools {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Throws BadInput if a recording would take away what none has left there. Of an earlier one truth.json is there.
void check_own(const std::string& dir) {
  std::error_code none;
  if (std::filesystem::exists(dir + "/truth.json", none)) return;
  for (const char* name :
       {"scans.carmen", "can.log", "poses.tum", "regions.gt", "scene.toml", "robot.toml", "labels.csv", "curbs.csv"}) {
    if (std::filesystem::exists(dir + "/" + name, none))
      throw BadInput(dir + "/" + name + ": no file of a simulation, for no truth.json is beside it; expected a " +
                     "directory without it");
  }
}

/// The files of one recording. What this recording lacks is taken away if an earlier one left it there, and so is what
/// was found in that one.
class Recording {
 public:
  Recording(const std::string& dir, const Robot& robot, bool with_poses) : dir_(dir), robot_(robot) {
    check_own(dir);
    std::error_code failed;
    std::filesystem::create_directories(dir, failed);
    if (failed) {
      throw BadInput(dir + ": " + failed.message() + "; expected a directory to write to");
    }
    truth_ = open("truth.json");  // the first to take its place: of what is cut off, the next run knows what it is
    scans_ = open("scans.carmen");
    can_ = robot.tilt.fixed ? leave_out("can.log") : open("can.log");
    poses_ = with_poses ? open("poses.tum") : leave_out("poses.tum");
    leave_out("labels.csv");
    leave_out("curbs.csv");
  }

  std::ostream* open(const char* name) { return &files_.emplace_back(dir_ + "/" + name).stream(); }

  void take(const ScanLine& line) {
    scan_.time_ns = line.time_ns;
    scan_.start_angle_rad = static_cast<double>(robot_.laser.first_bearing_rad);
    scan_.angular_resolution_rad = static_cast<double>(robot_.laser.bearing_step_rad);
    scan_.field_of_view_rad = scan_.angular_resolution_rad * (robot_.laser.beams - 1);
    scan_.maximum_range_m = static_cast<double>(robot_.laser.max_range_m);
    scan_.accuracy_m = static_cast<double>(robot_.laser.range_sd_m);
    scan_.ranges_m.assign(line.ranges_m.begin(), line.ranges_m.end());
    write_carmen(*scans_, scan_);
    ++summary.lines;
    summary.beams += static_cast<std::int64_t>(line.ranges_m.size());
    summary.returns +=
        std::count_if(line.ranges_m.begin(), line.ranges_m.end(), [](float r) { return std::isfinite(r); });
  }

  void take(const Truth& truth) { write_truth(*truth_, truth); }

  void take(const can::Frame& frame) {
    write_can_frame(*can_, frame, "can0");
    ++summary.tilt_frames;
  }

  void take(const SimulatedPose& pose) {
    const Eigen::Vector3d p = pose.T_map_base.translation();
    const Eigen::Quaterniond q(pose.T_map_base.linear());
    write_trajectory_pose(*poses_, {pose.time_ns, p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()});
    ++summary.poses;
  }

  void commit() {
    for (AtomicFile& file : files_) file.flush();
    for (AtomicFile& file : files_) file.commit();
    for (const char* name : left_out_) std::filesystem::remove(dir_ + "/" + name);
  }

  SimulationSummary summary;

 private:
  std::ostream* leave_out(const char* name) {
    left_out_.push_back(name);
    return nullptr;
  }

  std::string dir_;
  const Robot& robot_;
  std::list<AtomicFile> files_;
  std::vector<const char*> left_out_;
  std::ostream *truth_ = nullptr, *scans_ = nullptr, *can_ = nullptr, *poses_ = nullptr;
  CarmenLine scan_;
};

}  // namespace

SimulationSummary simulate(const Scene& scene, const std::string& robot_file, const std::string& out_dir,
                           const SimulationOptions& options) {
  const Robot robot = read_robot(robot_file);
  Simulation simulation(scene, robot, options.seed, options.duration_s);
  const Truth truth = make_truth(in_map_frame(scene), static_cast<double>(simulated_start_ns) * 1e-9);
  const std::string robot_text = text_of(robot_file);

  Recording recording(out_dir, robot, gives_poses(scene, robot));
  recording.summary.duration_s = simulation.duration_s();
  while (const std::optional<SimulatedEvent> event = simulation.next()) {
    std::visit([&](const auto& sample) { recording.take(sample); }, *event);
  }
  recording.take(truth);
  write_regions(*recording.open("regions.gt"), drawn_regions(truth));
  *recording.open("scene.toml") << scene.source;
  *recording.open("robot.toml") << robot_text;
  recording.commit();
  return recording.summary;
}

}  // namespace curbline::tools
