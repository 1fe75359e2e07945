// What the program does with files that can be read: logs of any times and contents are replayed to their end, or
// refused with one line, on a bus too, and any points are mapped in any window, by every method, and drawn.
#include <cairo.h>

#include <CLI/Error.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "formats/can_log.hpp"
#include "formats/carmen.hpp"
#include "formats/trajectory.hpp"
#include "fuzz/claim.hpp"
#include "fuzz/files.hpp"
#include "fuzz/run.hpp"
#include "picture/page.hpp"
#include "program/map_cloud.hpp"
#include "program/map_window.hpp"
#include "program/replay.hpp"
#include "streams/recorded_times.hpp"

namespace curbline::fuzz {
namespace {

using namespace tools;

constexpr int beams = 12;

void check_map(const Map& map) {
  claim(map.cells.size() == map.grid.cells(), "each cell is in the map");
  for (const MapCell& cell : map.cells)
    claim(cell.points >= 0 && cell.label >= -1 && cell.probability >= 0 && cell.probability <= 1, "and can be written");
}

Robot some_robot(Numbers& numbers) {
  Robot robot;
  robot.file = "robot.toml";
  robot.window.rows = robot.window.cols = 12;
  robot.window.origin_y_m = -0.6f;
  robot.laser.beams = beams;
  robot.laser.first_bearing_rad = -0.6f;
  robot.laser.bearing_step_rad = 0.1f;
  robot.tilt.T_base_tilt.z_m = 1.0f;
  robot.tilt.fixed = numbers.flag();
  robot.tilt.fixed_tilt_rad = 1.0f;
  robot.pose.still = numbers.flag();
  robot.pose.height_sd_m = 0.003f;
  robot.pose.attitude_sd_rad = 0.001f;
  return robot;
}

/// Mostly a little after the one before; a log has none before 1970.
std::int64_t next_time_ns(Numbers& numbers, std::int64_t before_ns) {
  if (numbers.seldom()) return numbers.flag() ? INT64_MAX - numbers.whole(0, 30'000) : numbers.time_ns() & INT64_MAX;
  return std::max<std::int64_t>(0, before_ns % (INT64_MAX / 2) + numbers.whole(-5'000'000, 25'000'000));
}

std::string some_scans(Numbers& numbers, const LaserSettings& laser) {
  std::ostringstream out;
  std::array<float, beams> ranges_m;
  std::int64_t time_ns = 1'000'000'000;
  for (int lines = numbers.whole(1, 40); lines > 0; --lines) {
    for (float& range_m : ranges_m) range_m = numbers.number(0.9f, 1.6f);
    time_ns = next_time_ns(numbers, time_ns);
    write_carmen(out, to_carmen({time_ns, ranges_m}, laser));
  }
  return out.str();
}

std::string some_frames(Numbers& numbers, const can::Signal& signal) {
  std::ostringstream out;
  std::int64_t time_ns = 1'000'000'000;
  for (int frames = numbers.whole(1, 60); frames > 0; --frames) {
    can::Frame frame;
    frame.time_ns = time_ns = next_time_ns(numbers, time_ns);
    frame.id = numbers.seldom() ? 0x7FF : signal.id;
    frame.length = 8;
    can::encode(signal, static_cast<double>(numbers.number(0.5f, 1.5f)), frame);
    write_can_frame(out, frame, "can0");
  }
  return out.str();
}

std::string some_poses(Numbers& numbers) {
  std::ostringstream out;
  std::int64_t time_ns = 1'000'000'000;
  for (int poses = numbers.whole(1, 30); poses > 0; --poses) {
    time_ns = std::max(time_ns, next_time_ns(numbers, time_ns));
    const double x_m = static_cast<double>(numbers.number(0.0f, numbers.seldom() ? 1e6f : 1.0f));
    write_trajectory_pose(out, {time_ns, x_m, 0, 0, 0, 0, 0, 1});
  }
  return out.str();
}

MapOptions some_options(Numbers& numbers, double furthest_m) {
  constexpr std::array methods{MapMethod::curbline, MapMethod::crf_em, MapMethod::em,
                               MapMethod::segment,  MapMethod::canny,  MapMethod::gradient};
  const auto number = [&](float low, float high) { return static_cast<double>(numbers.number(low, high)); };
  MapOptions options;
  options.method = methods[static_cast<std::size_t>(numbers.whole(0, 5))];
  options.cell = {numbers.flag() ? number(0.001f, numbers.flag() ? 0.02f : 10.0f) : 0.1};
  if (numbers.flag()) options.cell.push_back(number(0.001f, 10.0f));
  if (numbers.flag()) furthest_m = 2;
  const auto place = [&] { return furthest_m * number(-1.0f, 1.0f); };
  options.origin = {place(), place()};
  options.size = {number(0.0f, 15.0f) * options.cell.front(), number(0.0f, 15.0f) * options.cell.back()};
  if (numbers.seldom()) options.max_height_m = number(-1e9f, 1e9f);
  return options;
}

void replay(Numbers& numbers) {
  Robot robot = some_robot(numbers);
  MapOptions options;
  if (numbers.flag()) options = some_options(numbers, static_cast<double>(WindowSettings::furthest_m));
  const File scans(some_scans(numbers, robot.laser)), poses(robot.pose.still ? "" : some_poses(numbers)),
      can(robot.tilt.fixed ? "" : some_frames(numbers, robot.tilt_signal));
  try {
    apply_window(options, robot.window);
    Replay replay(robot, {scans.path(), can.path(), poses.path()});
    std::vector<Point> points;
    const bool batch = numbers.seldom();
    while (replay.step(batch ? &points : nullptr)) continue;
    replay.remarks();
    replay.check_complete();
    for (const MapCurb& curb : replay.all_curbs()) claim(std::isfinite(curb.height_m), "a curb has a height");
    if (options.fixed()) check_map(crop(replay.pipeline().map(), asked_grid(options, robot.window)));
  } catch (const BadInput& bad) {
    check_line(bad);
  } catch (const CLI::ValidationError&) {
  }
}

/// Frames of a bus on which a log is played, some of them others, at any times of the host.
void follow_bus(Numbers& numbers) {
  const can::Signal signal = can::cia402_position(1);
  const File log(some_frames(numbers, signal));
  CanLogReader played(log.path());
  LogClock clock(RecordedTimes(log.path(), signal, std::nullopt));
  std::int64_t host_ns = 0;
  long given = 0;
  try {
    while (auto frame = played.next()) {
      host_ns = next_time_ns(numbers, host_ns) % RisingTimes::furthest_ns;
      frame->time_ns = host_ns;
      if (numbers.seldom()) frame->data[0] = numbers.byte();
      if (numbers.seldom()) continue;  // lost
      clock.set_log_time(*frame, 1'000'000'000);
      claim(clock.not_recorded() <= ++given && clock.recorded()->missed() >= 0, "each frame is counted once");
    }
  } catch (const BadInput& bad) {
    check_line(bad);
  }
}

void draw(const Map& map) {
  const picture::Page page = picture::lay_out(map, {});
  claim(page.width > 0 && page.width <= 2000 && page.height > 0 && page.height <= 2000, "a page has a size");
  const picture::Surface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(page.width), static_cast<int>(page.height)));
  const picture::Context cr(cairo_create(surface.get()));
  picture::draw(cr.get(), page, map, {});
  claim(cairo_status(cr.get()) == CAIRO_STATUS_SUCCESS, "every map can be drawn");
}

std::vector<Point3> some_points(Numbers& numbers, const MapOptions& options) {
  std::vector<Point3> cloud{{options.origin[0], options.origin[1], 0}};
  while (!numbers.used_up()) {
    const auto along = [&](std::size_t axis) {
      if (numbers.seldom()) return static_cast<double>(numbers.any());
      return options.origin[axis] + static_cast<double>(numbers.number(0.0f, 1.0f)) * options.size[axis];
    };
    const double x = along(0), y = along(1), z = static_cast<double>(numbers.rarely_any(numbers.flag() ? 0.0f : 0.1f));
    if (std::isfinite(x) && std::isfinite(y) && std::isfinite(z)) cloud.push_back({x, y, z});
  }
  return cloud;
}

/// In the order in which a scanner measures them, each line farther away.
std::vector<Point3> some_scan(Numbers& numbers) {
  constexpr std::size_t beams_of_line = 20;
  std::vector<Point3> cloud;
  while (!numbers.used_up()) {
    const std::size_t line = cloud.size() / beams_of_line, beam = cloud.size() % beams_of_line;
    const double bearing_rad = 0.02 * static_cast<double>(beam), step_m = numbers.byte() / 1000.0;
    const double range_m = 1 + 0.1 * static_cast<double>(line) + step_m,
                 z = static_cast<double>(numbers.rarely_any(0.0f));
    if (!std::isfinite(z)) continue;
    cloud.push_back({range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad), z - step_m});
  }
  return cloud;
}

void map(Numbers& numbers) {
  const MapOptions options = some_options(numbers, 1e9);
  const bool drawn = numbers.seldom();  // which takes many times as long as the map
  const std::vector<Point3> cloud = numbers.flag() ? some_scan(numbers) : some_points(numbers, options);
  try {
    const Map map = map_cloud(cloud, options);
    check_map(map);
    if (drawn) draw(map);
  } catch (const BadInput& bad) {
    check_line(bad);
  } catch (const CLI::ValidationError&) {
  }
}

}  // namespace

void run(Numbers& numbers) {
  switch (numbers.whole(0, 4)) {
    case 0:
      return follow_bus(numbers);
    case 1:
    case 2:
      return replay(numbers);
    default:
      return map(numbers);
  }
}

}  // namespace curbline::fuzz

/// Fontconfig keeps what it has read of the fonts.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libfontconfig";
}
