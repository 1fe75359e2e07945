// Bad settings are refused with the Status that names them; the defaults and the bounds themselves are accepted.
#include "curbline/settings.hpp"

#include <catch2/catch.hpp>
#include <initializer_list>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "curbline/math.hpp"

namespace curbline {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();

constexpr Limits limits{};

/// CHECKs the Status and name for each of some bad values of one setting.
template <typename Reach, typename Value>
void refuses(Status expected, const std::string& name, Reach&& reach, std::initializer_list<Value> values) {
  for (const Value value : values) {
    Settings settings;
    reach(settings) = value;
    INFO("value " << value);
    CHECK(check(settings, limits) == expected);
    REQUIRE(bad_setting(settings, limits) != nullptr);
    CHECK(bad_setting(settings, limits) == name);
  }
}

const char* named(const Settings& settings) {
  const char* bad = bad_setting(settings, limits);
  return bad == nullptr ? "none" : bad;
}

TEST_CASE("settings: the defaults are good") {
  CHECK(check(Settings{}, limits) == Status::ok);
  CHECK(bad_setting(Settings{}, limits) == nullptr);
}

TEST_CASE("settings: the bounds themselves are good") {
  Settings low;
  low.window = {4, 4, 0.001f, 0.001f, -WindowSettings::furthest_m, -WindowSettings::furthest_m};
  low.laser.beams = 1;
  low.laser.first_bearing_rad = -2.0f * pi;
  low.laser.bearing_step_rad = -1.0f;
  low.laser.beam_interval_s = low.laser.min_range_m = low.laser.range_sd_m = low.laser.bearing_sd_rad = 0.0f;
  low.laser.beam_divergence_rad = 0.0f;
  low.tilt.T_base_tilt = low.tilt.T_tilt_laser = {-100.0f, -100.0f, -100.0f, -2.0f * pi, -2.0f * pi, -2.0f * pi};
  low.tilt.fixed_tilt_rad = -pi;
  low.tilt.latency_s = -10.0f;
  low.tilt.latency_sd_s = low.tilt.angle_sd_rad = low.tilt.time_sd_s = low.tilt.max_extrapolation_s = 0.0f;
  low.tilt.roll_sd_rad = low.tilt.pitch_sd_rad = 0.0f;
  low.pose.height_sd_m = low.pose.attitude_sd_rad = low.pose.lean_sd_rad = low.pose.max_extrapolation_s = 0.0f;
  low.segmentation.cell = {1e-3f, 1e-10f};
  low.segmentation.link_reach = low.labels.link_reach = low.curbs.link_reach = 1;
  low.planes.prior = {1e-10f, 0.0f, 1.0f, PlanePrior::least_common_share, 0.0f};
  low.planes.min_cells = 3.0f;
  low.labels.coupling = 0.01f;
  low.tilt.max_gap_s = 1e-4f;
  low.segmentation.leaf_scale = low.curbs.max_step_m = 1e-3f;
  low.labels.max_messages = 4;
  CHECK(std::string(named(low)) == "none");

  Settings high;
  high.window = {40, 40, 10.0f, 10.0f, WindowSettings::furthest_m, WindowSettings::furthest_m};
  high.laser.beams = 1;
  high.laser.first_bearing_rad = 2.0f * pi;
  high.laser.bearing_step_rad = high.laser.beam_interval_s = high.laser.bearing_sd_rad = 1.0f;
  high.laser.max_range_m = 1e6f;
  high.laser.range_sd_m = 10.0f;
  high.laser.beam_divergence_rad = 1.0f;
  high.tilt.T_base_tilt = high.tilt.T_tilt_laser = {100.0f, 100.0f, 100.0f, 2.0f * pi, 2.0f * pi, 2.0f * pi};
  high.tilt.fixed_tilt_rad = pi;
  high.tilt.latency_s = high.tilt.max_extrapolation_s = high.tilt.max_gap_s = 10.0f;
  high.tilt.latency_sd_s = high.tilt.angle_sd_rad = high.tilt.time_sd_s = 1.0f;
  high.tilt.roll_sd_rad = high.tilt.pitch_sd_rad = 1.0f;
  high.pose.height_sd_m = high.pose.max_extrapolation_s = 10.0f;
  high.pose.attitude_sd_rad = 1.0f;
  high.pose.lean_sd_rad = 0.05f;
  high.segmentation.cell = {1e6f, 100.0f};
  high.segmentation.link_reach = high.labels.link_reach = high.curbs.link_reach = 15;
  high.planes.prior = {100.0f, 100.0f, 1e6f, 1.0f, 10.0f};
  high.planes.min_cells = 1e6f;
  high.labels.coupling = 7.9f;
  high.segmentation.leaf_scale = 1e6f;
  high.curbs.max_step_m = 1000.0f;
  CHECK(std::string(named(high)) == "none");
}

TEST_CASE("settings: a bad window is named") {
  constexpr Status bad = Status::bad_window;
  refuses(bad, "window.rows", [](Settings& s) -> int& { return s.window.rows; }, {0, -4, 3, 6, 41, 44});
  refuses(bad, "window.cols", [](Settings& s) -> int& { return s.window.cols; }, {0, -4, 3, 6, 41, 44});
  refuses(bad, "window.cell_x_m", [](Settings& s) -> float& { return s.window.cell_x_m; },
          {0.0f, 9e-4f, -0.1f, 10.1f, nan, infinity});
  refuses(bad, "window.cell_y_m", [](Settings& s) -> float& { return s.window.cell_y_m; },
          {0.0f, 9e-4f, -0.1f, 10.1f, nan, infinity});
  refuses(bad, "window.origin_x_m", [](Settings& s) -> float& { return s.window.origin_x_m; },
          {1.01e5f, -1.01e5f, nan, infinity});
  refuses(bad, "window.origin_y_m", [](Settings& s) -> float& { return s.window.origin_y_m; },
          {1.01e5f, -1.01e5f, nan, -infinity});
  refuses(bad, "window.max_height_m", [](Settings& s) -> float& { return s.window.max_height_m; }, {nan, infinity});
}

TEST_CASE("settings: a bad laser is named") {
  constexpr Status bad = Status::bad_laser;
  refuses(bad, "laser.beams", [](Settings& s) -> int& { return s.laser.beams; }, {0, -1, 1082});
  refuses(bad, "laser.first_bearing_rad", [](Settings& s) -> float& { return s.laser.first_bearing_rad; }, {7.0f, nan});
  refuses(bad, "laser.bearing_step_rad", [](Settings& s) -> float& { return s.laser.bearing_step_rad; },
          {0.0f, 1.1f, 0.05f, nan});
  refuses(bad, "laser.beam_interval_s", [](Settings& s) -> float& { return s.laser.beam_interval_s; },
          {-1e-6f, 1.1f, nan});
  refuses(bad, "laser.min_range_m", [](Settings& s) -> float& { return s.laser.min_range_m; }, {-0.1f, nan});
  refuses(bad, "laser.max_range_m", [](Settings& s) -> float& { return s.laser.max_range_m; },
          {0.1f, 0.0f, nan, infinity});
  refuses(bad, "laser.range_sd_m", [](Settings& s) -> float& { return s.laser.range_sd_m; }, {-0.01f, nan, infinity});
  refuses(bad, "laser.bearing_sd_rad", [](Settings& s) -> float& { return s.laser.bearing_sd_rad; },
          {-0.01f, nan, infinity});
  refuses(bad, "laser.beam_divergence_rad", [](Settings& s) -> float& { return s.laser.beam_divergence_rad; },
          {-0.001f, 1.1f, nan});
}

TEST_CASE("settings: of a shortest range beyond the longest the longest is named") {
  refuses(Status::bad_laser, "laser.max_range_m", [](Settings& s) -> float& { return s.laser.min_range_m; }, {60.0f});
}

TEST_CASE("settings: a bad tilt is named") {
  constexpr Status bad = Status::bad_tilt;
  for (const auto& [mount, name] : {std::pair{&TiltSettings::T_base_tilt, "tilt.T_base_tilt"},
                                    {&TiltSettings::T_tilt_laser, "tilt.T_tilt_laser"}}) {
    for (float MountSettings::*length : {&MountSettings::x_m, &MountSettings::y_m, &MountSettings::z_m}) {
      refuses(bad, name, [&, mount = mount](Settings& s) -> float& { return s.tilt.*mount.*length; },
              {101.0f, -101.0f, nan});
    }
    for (float MountSettings::*angle : {&MountSettings::roll_rad, &MountSettings::pitch_rad, &MountSettings::yaw_rad}) {
      refuses(bad, name, [&, mount = mount](Settings& s) -> float& { return s.tilt.*mount.*angle; },
              {6.5f, -6.5f, nan, infinity});
    }
  }
  refuses(bad, "tilt.fixed_tilt_rad", [](Settings& s) -> float& { return s.tilt.fixed_tilt_rad; }, {4.0f, nan});
  refuses(bad, "tilt.latency_s", [](Settings& s) -> float& { return s.tilt.latency_s; }, {10.1f, -10.1f, nan});
  refuses(bad, "tilt.latency_sd_s", [](Settings& s) -> float& { return s.tilt.latency_sd_s; }, {-1e-3f, 1.01f, nan});
  refuses(bad, "tilt.max_extrapolation_s", [](Settings& s) -> float& { return s.tilt.max_extrapolation_s; },
          {-0.1f, 10.1f, nan});
  refuses(bad, "tilt.max_gap_s", [](Settings& s) -> float& { return s.tilt.max_gap_s; }, {0.0f, 10.1f, nan});
  for (const auto& [sd, name] : {std::pair{&TiltSettings::angle_sd_rad, "tilt.angle_sd_rad"},
                                 {&TiltSettings::time_sd_s, "tilt.time_sd_s"},
                                 {&TiltSettings::roll_sd_rad, "tilt.roll_sd_rad"},
                                 {&TiltSettings::pitch_sd_rad, "tilt.pitch_sd_rad"}}) {
    refuses(bad, name, [&, sd = sd](Settings& s) -> float& { return s.tilt.*sd; }, {-0.001f, nan, infinity});
  }
}

TEST_CASE("settings: a bad pose is named") {
  constexpr Status bad = Status::bad_pose;
  refuses(bad, "pose.height_sd_m", [](Settings& s) -> float& { return s.pose.height_sd_m; }, {-0.1f, nan, infinity});
  refuses(bad, "pose.attitude_sd_rad", [](Settings& s) -> float& { return s.pose.attitude_sd_rad; },
          {-0.1f, nan, infinity});
  refuses(bad, "pose.lean_sd_rad", [](Settings& s) -> float& { return s.pose.lean_sd_rad; }, {-0.1f, 0.06f, nan});
  refuses(bad, "pose.max_extrapolation_s", [](Settings& s) -> float& { return s.pose.max_extrapolation_s; },
          {-0.1f, 10.1f, nan});
}

TEST_CASE("settings: bad constants of inference are named") {
  constexpr Status bad = Status::bad_inference;
  refuses(bad, "segmentation.cell.degrees", [](Settings& s) -> float& { return s.segmentation.cell.degrees; },
          {0.0f, nan});
  refuses(bad, "segmentation.cell.variance_m2", [](Settings& s) -> float& { return s.segmentation.cell.variance_m2; },
          {0.0f, nan});
  refuses(bad, "segmentation.leaf_scale", [](Settings& s) -> float& { return s.segmentation.leaf_scale; },
          {0.0f, -1.0f, nan});
  refuses(bad, "segmentation.link_reach", [](Settings& s) -> int& { return s.segmentation.link_reach; }, {0, 16});
  refuses(bad, "planes.prior.noise_m2", [](Settings& s) -> float& { return s.planes.prior.noise_m2; },
          {0.0f, nan, infinity});
  refuses(bad, "planes.prior.texture_m2", [](Settings& s) -> float& { return s.planes.prior.texture_m2; },
          {-1e-6f, 1.1e-4f, nan, infinity});  // no more than the noise of which it is a part
  refuses(bad, "planes.prior.degrees", [](Settings& s) -> float& { return s.planes.prior.degrees; },
          {0.9f, nan, infinity});
  refuses(bad, "planes.prior.common_share", [](Settings& s) -> float& { return s.planes.prior.common_share; },
          {-0.1f, 1.1f, nan});
  refuses(bad, "planes.prior.curvature_1_m", [](Settings& s) -> float& { return s.planes.prior.curvature_1_m; },
          {-0.1f, 11.0f, nan});
  refuses(bad, "planes.min_cells", [](Settings& s) -> float& { return s.planes.min_cells; }, {2.0f, nan});
  refuses(bad, "labels.coupling", [](Settings& s) -> float& { return s.labels.coupling; }, {0.0f, -1.0f, 8.0f, nan});
  refuses(bad, "labels.link_reach", [](Settings& s) -> int& { return s.labels.link_reach; }, {0, 16});
  refuses(bad, "labels.max_messages", [](Settings& s) -> int& { return s.labels.max_messages.emplace(); },
          {3, 1, 0, -1});
  refuses(bad, "curbs.link_reach", [](Settings& s) -> int& { return s.curbs.link_reach; }, {0, 16});
  refuses(bad, "curbs.max_step_m", [](Settings& s) -> float& { return s.curbs.max_step_m; }, {0.0f, nan, infinity});
}

TEST_CASE("settings: a standard deviation in the wrong unit is named") {
  refuses(Status::bad_laser, "laser.range_sd_m", [](Settings& s) -> float& { return s.laser.range_sd_m; }, {11.0f});
  refuses(Status::bad_laser, "laser.bearing_sd_rad", [](Settings& s) -> float& { return s.laser.bearing_sd_rad; },
          {1.1f});
  refuses(Status::bad_tilt, "tilt.angle_sd_rad", [](Settings& s) -> float& { return s.tilt.angle_sd_rad; }, {1.1f});
  refuses(Status::bad_tilt, "tilt.time_sd_s", [](Settings& s) -> float& { return s.tilt.time_sd_s; }, {1.1f});
  refuses(Status::bad_tilt, "tilt.pitch_sd_rad", [](Settings& s) -> float& { return s.tilt.pitch_sd_rad; }, {1.1f});
  refuses(Status::bad_pose, "pose.height_sd_m", [](Settings& s) -> float& { return s.pose.height_sd_m; }, {11.0f});
  refuses(Status::bad_pose, "pose.attitude_sd_rad", [](Settings& s) -> float& { return s.pose.attitude_sd_rad; },
          {1.1f});
}

TEST_CASE("settings: the last beam of a line is measured as many whole intervals after the first") {
  LaserSettings laser;
  laser.beam_interval_s = 1.5e-6f;
  CHECK(laser.duration_ns(0) == 0);
  CHECK(laser.duration_ns(1) == 0);
  CHECK(laser.duration_ns(1081) == 1080 * 1500);
}

TEST_CASE("settings: a scanner that turns clockwise is good") {
  Settings settings;
  settings.laser.first_bearing_rad = 2.356f;
  settings.laser.bearing_step_rad = -0.00436f;
  CHECK(check(settings, limits) == Status::ok);
}

TEST_CASE("status: each has words of its own") {
  std::set<std::string> words;
  for (int k = 0; k <= static_cast<int>(Status::no_pose); ++k) words.insert(to_string(static_cast<Status>(k)));
  CHECK(words.size() == static_cast<std::size_t>(Status::no_pose) + 1);
  CHECK(words.count("unknown status") == 0);
}

}  // namespace
}  // namespace curbline
