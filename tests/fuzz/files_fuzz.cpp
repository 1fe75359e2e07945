// An arbitrary file, read as the format named by FORMAT: it is read to its end, or refused with one line that names the
// file. Nothing else is thrown, and what has been read satisfies what the format's reader promises.
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>

#include "curbline/curbline.hpp"
#include "drive_streams/drive_streams.hpp"
#include "evaluation/scores.hpp"
#include "formats/can_log.hpp"
#include "formats/carmen.hpp"
#include "formats/cloud.hpp"
#include "formats/csv.hpp"
#include "formats/dbc.hpp"
#include "formats/regions.hpp"
#include "formats/trajectory.hpp"
#include "fuzz/claim.hpp"
#include "fuzz/files.hpp"
#include "pose_feed.hpp"
#include "robot/robot.hpp"
#include "simulator/ground_plan.hpp"
#include "simulator/truth.hpp"

namespace curbline::fuzz {
namespace {

/// A second name of the file, in a folder of its own, for readers that look for a name or choose the format by its
/// ending.
class Named {
 public:
  Named(const File& file, const char* name)
      : folder_("/tmp/curbline-fuzz-" + std::to_string(::getpid())), path_(folder_ + "/" + name) {
    ::mkdir(folder_.c_str(), 0700);
    ::unlink(path_.c_str());  // left over from a process that was killed
    claim(::symlink(file.path().c_str(), path_.c_str()) == 0, "it has a second name");
  }
  ~Named() {
    ::unlink(path_.c_str());
    ::rmdir(folder_.c_str());
  }
  Named(const Named&) = delete;
  Named& operator=(const Named&) = delete;

  const std::string& folder() const { return folder_; }
  const std::string& path() const { return path_; }

 private:
  std::string folder_, path_;
};

void read_carmen(const File& file) {
  tools::CarmenReader reader(file.path());
  while (const auto line = reader.next()) {
    for (const float range : line->ranges_m) claim(std::isnan(range) || range > 0.0f, "a range is above 0, or none");
  }
}

void read_can_log(const File& file) {
  tools::CanLogReader reader(file.path());
  while (const auto frame = reader.next()) claim(frame->length <= 64, "a frame has 64 bytes at most");
}

void read_trajectory(const File& file) {
  tools::TrajectoryReader reader(file.path());
  while (const auto pose = reader.next()) {
    const Pose p = tools::to_pose(*pose);
    const float norm2 = p.qx * p.qx + p.qy * p.qy + p.qz * p.qz + p.qw * p.qw;
    claim(std::abs(p.x_m) <= Pose::furthest_m && std::abs(norm2 - 1.0f) < 1e-3f, "the pipeline takes every pose");
  }
}
void read_live_poses(const File& file) {
  daemon::PoseFeed feed;
  feed.open(file.path());
  while (const auto pose = feed.next()) claim(pose->time_ns >= 0, "a time is none before the epoch");
  claim(feed.descriptor() < 0, "what has ended is not asked again");
}

void read_points(const File& file, const char* name) {
  const Named named(file, name);
  for (const tools::Point3& p : tools::read_cloud(named.path()))
    claim(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "every point is a place");
}
void read_cloud_text(const File& file) {
  read_points(file, "a.xyz");
}
void read_cloud_pcd(const File& file) {
  read_points(file, "a.pcd");
}
void read_cloud_kitti(const File& file) {
  read_points(file, "a.bin");
}

void read_regions(const File& file) {
  for (const tools::Polygon& region : tools::read_regions(file.path()))
    claim(region.size() >= 3, "a region has three corners at least");
}

void read_dbc(const File& file) {
  const std::string path = file.path();
  const tools::Dbc dbc = tools::read_dbc(path);
  for (const tools::DbcMessage& message : dbc) {
    for (const tools::DbcSignal& signal : message.signals) {
      try {
        claim(can::valid(tools::find_signal(dbc, path, message.name, signal.name).signal),
              "a signal that is found can be decoded");
      } catch (const tools::BadInput&) {
      }
    }
  }
}

void read_robot(const File& file) {
  constexpr Limits host{.rows = 512, .cols = 512, .planes = 255, .beams = tools::most_beams};
  const tools::Robot robot = tools::read_robot(file.path());
  claim(check(tools::pipeline_settings(robot), host) == Status::ok, "the pipeline takes every robot");
  claim(can::valid(robot.tilt_signal), "its tilt signal can be decoded");
}

void read_scene(const File& file) {
  const tools::Scene scene = tools::read_scene(file.path());
  claim(!scene.path.waypoints.empty(), "the robot is somewhere");
  tools::legs(scene.path);
  tools::GroundPlan(scene.regions).region_at(scene.path.waypoints.front());
}

/// What is scored beside the file: a pavement and a road, seen 1 m around a curb of 12 cm.
const tools::Truth& small_truth() {
  static const tools::Truth truth = [] {
    tools::Truth t;
    t.planes = {{"road", {}}, {"pavement", {.z0_m = 0.12}}};
    t.regions = {{"road", {}, 0}, {"pavement", tools::rectangle({0, -1}, {1, 1}), 1}};
    t.curbs = {{{0, -1}, {0, 1}, -0.12, -0.12, 0, 0.12, 0.12, "step"}};
    return t;
  }();
  return truth;
}
std::vector<tools::LabelledCell> small_window() {
  std::vector<tools::LabelledCell> cells;
  for (int i = -10; i < 10; ++i) {
    for (int j = -10; j < 10; ++j)
      cells.push_back({(i + 0.5) * 0.1, (j + 0.5) * 0.1, {.height_m = i < 0 ? 0 : 0.12, .points = 1, .label = i >= 0}});
  }
  return cells;
}
const tools::MapCurb small_curb{.y0_m = -1, .y1_m = 1, .height_m = 0.12, .height_sd_m = 0.001, .kind = "step_up"};

bool is_share(double value) {
  return std::isnan(value) || (value >= -1e-9 && value <= 1 + 1e-9);
}
void score(const tools::Found& found, const tools::Truth& truth) {
  tools::Seen seen;
  for (const auto& window : found.windows) {
    for (const tools::LabelledCell& cell : window) seen.add(cell.x_m, cell.y_m);
  }
  const tools::PlaneScores planes = tools::score_planes(found, truth);
  claim(is_share(planes.v) && is_share(planes.v_readings), "a V-measure is a share");
  for (const tools::StepRates& at : tools::score_curbs(found, truth, seen).at)
    claim(is_share(at.precision) && is_share(at.recall) && is_share(at.f1), "and so are rates");
  for (const tools::CurbMatch& match : tools::match_steps(found, truth, seen))
    claim(is_share(match.covered), "and what is covered of a curb");
}

void read_labels(const File& file) {
  const std::string path = file.path();
  score({{tools::read_labels(path)}, {small_curb}, {}, path}, small_truth());
}

void read_curbs(const File& file) {
  score({{small_window()}, tools::read_curbs(file.path()), tools::Point2{-1, 0}}, small_truth());
}

void read_truth(const File& file) {
  const Named named(file, "truth.json");
  score({{small_window()}, {small_curb}, tools::Point2{-1, 0}}, tools::read_truth(named.folder()));
}

void read_drive_results(const File& file) {
  for (const tools::MapCurb& curb : tools::read_last_curbs(file.path()))
    claim(!curb.kind.empty(), "a curb is of some kind");
}

struct Format {
  const char* name;
  void (*read)(const File&);
};
constexpr std::array<Format, 15> formats{{{"carmen", read_carmen},
                                          {"can_log", read_can_log},
                                          {"trajectory", read_trajectory},
                                          {"live_poses", read_live_poses},
                                          {"cloud_text", read_cloud_text},
                                          {"cloud_pcd", read_cloud_pcd},
                                          {"cloud_kitti", read_cloud_kitti},
                                          {"regions", read_regions},
                                          {"labels", read_labels},
                                          {"curbs", read_curbs},
                                          {"truth", read_truth},
                                          {"drive_results", read_drive_results},
                                          {"dbc", read_dbc},
                                          {"robot", read_robot},
                                          {"scene", read_scene}}};

const Format& format() {
  const char* name = std::getenv("FORMAT");
  for (const Format& f : formats) {
    if (name != nullptr && f.name == std::string_view(name)) return f;
  }
  std::fputs("FORMAT names none; expected one of", stderr);
  for (const Format& f : formats) std::fprintf(stderr, " %s", f.name);
  std::fputs("\n", stderr);
  std::exit(2);
}

}  // namespace
}  // namespace curbline::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace curbline::fuzz;
  static const Format& read_as = format();
  const File file({reinterpret_cast<const char*>(bytes), size});
  try {
    read_as.read(file);
  } catch (const curbline::tools::BadInput& bad) {
    const std::string line = bad.what();
    claim(line.starts_with("/proc/self/fd/") || line.starts_with("/tmp/curbline-fuzz-"), "it is told which file");
    check_line(bad);
  }
  return 0;
}
