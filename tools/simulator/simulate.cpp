#include "simulator/simulate.hpp"

#include "formats/atomic_file.hpp"
#include "formats/can_log.hpp"
#include "formats/carmen.hpp"
#include "formats/file_exists.hpp"
#include "formats/regions.hpp"
#include "formats/trajectory.hpp"
#include "robot/robot.hpp"
#include "simulator/simulation.hpp"
#include "simulator/truth.hpp"

#include <filesystem>
#include <list>

namespace curbline::tools {
namespace {

/// The files of one recording. Files of an earlier recording that this one does not have are removed, and so are the
/// results derived from the earlier one. The presence of truth.json shows that there was an earlier recording; without
/// it, existing files are refused.
class Recording {
 public:
  Recording(const std::string& dir, const Robot& robot, bool with_poses)
      : dir_(dir), laser_(robot.laser), after_another_(file_exists(dir + "/truth.json")) {
    std::error_code failed;
    std::filesystem::create_directories(dir, failed);
    if (failed) {
      throw BadInput(dir + ": " + failed.message() + "; expected a directory to write to");
    }
    truth_ = open("truth.json");  // committed first: if a run is interrupted, the next one recognises its directory
    scans_ = open("scans.carmen");
    can_ = robot.tilt.fixed ? leave_out("can.log") : open("can.log");
    poses_ = with_poses ? open("poses.tum") : leave_out("poses.tum");
    regions_ = open("regions.gt");
    scene_ = open("scene.toml");
    robot_text_ = open("robot.toml");
    leave_out("labels.csv");
    leave_out("curbs.csv");
  }

  void take(const ScanLine& line) {
    write_carmen(*scans_, to_carmen(line, laser_));
    ++summary.lines;
  }

  void take(const Truth& truth) {
    write_truth(*truth_, truth);
    write_regions(*regions_, drawn_regions(truth));
  }

  void take_sources(const std::string& scene, const std::string& robot) {
    *scene_ << scene;
    *robot_text_ << robot;
  }

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
    std::error_code none;
    for (const char* name : left_out_) std::filesystem::remove(dir_ + "/" + name, none);
  }

  SimulationSummary summary;

 private:
  std::ostream* open(const char* name) {
    check_own(name);
    return &files_.emplace_back(dir_ + "/" + name).stream();
  }
  std::ostream* leave_out(const char* name) {
    check_own(name);
    left_out_.push_back(name);
    return nullptr;
  }

  void check_own(const char* name) const {
    std::error_code none;
    if (std::filesystem::is_directory(dir_ + "/" + name, none))
      throw BadInput(dir_ + "/" + name + ": a directory; expected a simulation's file there, or none");
    if (!after_another_ && file_exists(dir_ + "/" + name))
      throw BadInput(dir_ + "/" + name + ": no file of a simulation, for no truth.json is beside it; expected a " +
                     "directory without it");
  }

  std::string dir_;
  LaserSettings laser_;
  bool after_another_;
  std::list<AtomicFile> files_;
  std::vector<const char*> left_out_;
  std::ostream *truth_ = nullptr, *scans_ = nullptr, *can_ = nullptr, *poses_ = nullptr;
  std::ostream *regions_ = nullptr, *scene_ = nullptr, *robot_text_ = nullptr;
};

}  // namespace

SimulationSummary simulate(const Scene& scene, const std::string& robot_file, const std::string& out_dir,
                           const SimulationOptions& options) {
  const std::string robot_text = read_robot_text(robot_file);  // once: it may be a pipe
  const Robot robot = parse_robot(robot_text, robot_file);
  Simulation simulation(scene, robot, options.seed, options.duration_s);
  const Truth truth = make_truth(in_map_frame(scene), static_cast<double>(simulated_start_ns) * 1e-9);

  Recording recording(out_dir, robot, gives_poses(scene, robot));
  recording.summary.duration_s = simulation.duration_s();
  while (const std::optional<SimulatedEvent> event = simulation.next()) {
    std::visit([&](const auto& sample) { recording.take(sample); }, *event);
  }
  recording.take(truth);
  recording.take_sources(scene.source, robot_text);
  recording.commit();
  return recording.summary;
}

}  // namespace curbline::tools
