#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "command_line/checks.hpp"
#include "formats/csv.hpp"
#include "program/commands.hpp"
#include "program/line_costs.hpp"
#include "program/map_cloud.hpp"
#include "program/map_command_line.hpp"
#include "program/map_outputs.hpp"
#include "program/map_window.hpp"
#include "program/replay.hpp"

namespace curbline::tools {
namespace {

struct Options {
  DriveLogs logs;
  std::string robot;
  std::string speed;
  std::string line_costs;
  MapOptions map;
};

/// Paces the replay by the log's times, `speed` times as fast; 0 does not wait.
class Pace {
 public:
  explicit Pace(double speed) : speed_(speed) {}
  void wait_for(std::int64_t log_time_ns) {
    if (speed_ <= 0) return;
    if (first_ns_ == none) first_ns_ = log_time_ns;
    const double since_start_ns = std::min(static_cast<double>(log_time_ns - first_ns_) / speed_, longest_ns);
    std::this_thread::sleep_until(start_ + std::chrono::nanoseconds(static_cast<std::int64_t>(since_start_ns)));
  }

 private:
  double speed_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  static constexpr std::int64_t none = INT64_MIN;
  static constexpr double longest_ns = 1e18;  // 30 years, which the steady clock can represent
  std::int64_t first_ns_ = none;
};

/// The speed, 0 for max. The frames of a live bus set the pace: its speed is 1, and scan lines are not held back.
double speed_of(const std::string& text, bool live) {
  if (text.empty() || (live && text == "1")) return 0;
  if (!live) return parse_speed(text);
  throw CLI::ValidationError("--speed", text + "; a live CAN interface has the speed 1");
}

/// Writes each curb that the last scan line added or changed, one JSON object a line, as far as that tells.
class CurbStream {
 public:
  /// False if standard output cannot be written.
  bool give_out(std::span<const Curb> curbs) {
    std::vector<std::string> now;
    for (const Curb& curb : curbs) {
      std::ostringstream line;
      write_curb_json(line, to_map_curb(curb));
      now.push_back(line.str());
      if (std::find(before_.begin(), before_.end(), now.back()) == before_.end()) std::cout << now.back();
    }
    before_ = std::move(now);
    return static_cast<bool>(std::cout.flush());
  }

 private:
  std::vector<std::string> before_;
};

nlohmann::json summary_of(const Replay& replay) {
  const Counters& c = replay.pipeline().counters();
  const can::TiltDecoderCounters can = replay.can_counters();
  const TiltLatency& latency = replay.pipeline().tilt_latency();
  const TiltLatency::Usual late = latency.usual();
  return {{"lines", c.lines},
          {"lines_dropped", c.lines_dropped},
          {"points", c.points},
          {"outside", c.outside},
          {"no_returns", c.no_returns},
          {"echoes_alone", c.echoes_alone},
          {"can_frames", can.frames},
          {"can_malformed", can.malformed},
          {"can_without_sync", can.without_sync},
          {"tilt_readings", replay.tilt_readings()},
          {"tilt_dropped", c.tilt_dropped},
          {"tilt_latency_offset_s", late.offset_s},
          {"lean_rad", latency.lean_rad()},
          {"tilt_latency_sd_s", late.sd_s},
          {"latency_steps", latency.steps()},
          {"beams_without_tilt", c.beams_without_tilt},
          {"beams_extrapolated", c.beams_extrapolated},
          {"lines_off_map", c.lines_off_map},
          {"poses_dropped", c.poses_dropped},
          {"regions_full", c.regions_full},
          {"links_full", c.links_full},
          {"planes_full", c.planes_full},
          {"curbs_full", c.curbs_full + c.borders_full},
          {"cells_deferred", c.cells_deferred}};
}

void check_files(const Options& o) {
  std::vector<NamedFile> outputs = outputs_of(o.map);
  outputs.push_back({"--line-costs", o.line_costs});
  check_outputs(outputs,
                {{"--scans", o.logs.scans}, {"--can", o.logs.can}, {"--poses", o.logs.poses}, {"--robot", o.robot}});
}

void run(const Options& o) {
  check_files(o);
  Pace pace(speed_of(o.speed, live_interface(o.logs.can).has_value()));
  Robot robot = read_robot(o.robot);
  if (!o.logs.poses.empty()) robot.pose.still = false;
  apply_window(o.map, robot.window);
  const bool batch = o.map.method != MapMethod::curbline;
  const bool streams = !batch && o.map.curbs == "-";
  check_map_outputs(o.map);
  check_writable({{"--line-costs", o.line_costs}});
  Replay replay(robot, o.logs);
  CurbStream stream;
  std::optional<LineCosts> costs;
  if (!o.line_costs.empty()) costs.emplace(o.line_costs);
  std::vector<Point> points;
  while (replay.step(batch ? &points : nullptr)) {
    if (costs) costs->add(replay);
    if (replay.status() == Status::ok) pace.wait_for(replay.line().time_ns);  // that of another may be damaged
    if (streams && !stream.give_out(replay.pipeline().curbs())) return;       // which run_program() tells
  }
  replay.check_complete();
  if (costs) costs->commit();
  if (const std::string remarks = replay.remarks(); !remarks.empty()) std::cerr << remarks << '\n';
  const Grid grid = o.map.fixed() ? asked_grid(o.map, robot.window) : replay.pipeline().grid();
  Map map;
  if (batch) {
    map = map_batch(cloud_of(points), grid, static_cast<double>(robot.window.max_height_m), o.map);
  } else {
    map = replay.pipeline().map();
    if (o.map.fixed()) {
      map = crop(map, grid);
    } else {
      map.curbs = replay.all_curbs();
    }
  }
  MapOptions out = o.map;
  if (streams) out.curbs.clear();  // they have been given out
  give_out(out, map, {.title = o.logs.scans, .robot = replay.robot()}, summary_of(replay));
}

}  // namespace

void add_replay(CLI::App& app) {
  auto* command =
      app.add_subcommand("replay", "Scan lines, tilt frames and poses to curbs, line by line, as on the robot");
  auto o = std::make_shared<Options>();
  command
      ->add_option("--scans", o->logs.scans,
                   "scan lines: a CARMEN log, or a live scanner, scip2:HOST[:PORT], cola:HOST[:PORT] or lms200:DEVICE")
      ->check(file_name())
      ->required();
  command
      ->add_option("--can", o->logs.can,
                   "tilt frames: a candump log, or can:IFACE, a live interface; none for a fixed tilt")
      ->check(file_name());
  command->add_option("--poses", o->logs.poses, "robot poses, TUM trajectory; none if the robot stands")
      ->check(file_name());
  command->add_option("--robot", o->robot, "robot description (TOML)")->check(file_name())->required();
  command
      ->add_option("--speed", o->speed,
                   "times as fast as the logs' own time, or max, as fast as can be: the default, but 1 with can:IFACE")
      ->check(speed());
  command->add_option("--line-costs", o->line_costs, "file to write: CSV, the time and work of each scan line")
      ->check(file_name());
  add_map_options(*command, o->map);
  constexpr auto furthest_m = static_cast<double>(WindowSettings::furthest_m);
  command->get_option("--origin")->check(within(-furthest_m, furthest_m, "metres in [-1e5, 1e5], of a robot's window"));
  command->footer(
      "A live scanner that is switched off, or Ctrl-C, ends the scan as the end of a log does: what was mapped is "
      "written,\n"
      "and the exit status is 0. stderr says after how many scan lines a scanner closed the connection.\n\n"
      "With can:IFACE, what the frames say, their order and their losses are the bus's. A bus carries no recorded "
      "times:\n"
      "each frame is given the time that the recording's own CAN log has for it (NAME.candump beside NAME.carmen, or\n"
      "can.log), else that of its arrival after the first frame, which stands for the first scan line.\n"
      "Start replay first, then canplayer -I LOG IFACE=can0.");
  command->callback([o] { run(*o); });
}

}  // namespace curbline::tools
