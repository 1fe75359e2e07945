#include "formats/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "formats/decimals.hpp"
#include "formats/fields.hpp"
#include "formats/parse_number.hpp"

namespace curbline::tools {
namespace {

double read_position(Fields& fields, std::string_view name) {
  const double metres = fields.number(name);
  if (std::abs(metres) > static_cast<double>(Pose::furthest_m))
    fields.fail(name, readable(metres, 3), "metres within 1000 km, better 1 km, of the map's origin");
  return metres;
}

/// The base's z axis along the map's. Below 0 a robot lies on its back, as a quaternion with qw first makes it while
/// its heading is within 90 degrees of 0.
double upward(double qx, double qy) {
  return 1 - 2 * (qx * qx + qy * qy);
}

void check_upright(const Fields& fields, const TrajectoryPose& pose) {
  const double up = upward(pose.qx, pose.qy);
  if (up < 0)
    fields.fail("the robot's tilt", readable(std::acos(std::max(up, -1.0)) * 180 / std::numbers::pi, 0) + " deg",
                "at most 90 deg, by qx qy qz qw in this order, z up");
}

TrajectoryPose read_pose(Fields& fields) {
  TrajectoryPose pose;
  pose.time_ns = fields.time_ns("time");
  pose.x_m = read_position(fields, "tx");
  pose.y_m = read_position(fields, "ty");
  pose.z_m = read_position(fields, "tz");
  pose.qx = fields.number("qx");
  pose.qy = fields.number("qy");
  pose.qz = fields.number("qz");
  pose.qw = fields.number("qw");
  fields.expect_end();
  const double norm = std::sqrt(pose.qx * pose.qx + pose.qy * pose.qy + pose.qz * pose.qz + pose.qw * pose.qw);
  if (!(std::abs(norm - 1.0) <= 0.01)) fields.fail("the quaternion's norm", readable(norm, 3), "1 within 0.01");
  for (double* part : {&pose.qx, &pose.qy, &pose.qz, &pose.qw}) *part /= norm;
  check_upright(fields, pose);
  return pose;
}

}  // namespace

Pose to_pose(const TrajectoryPose& pose) {
  const auto f = [](double value) { return static_cast<float>(value); };
  return {pose.time_ns, f(pose.x_m), f(pose.y_m), f(pose.z_m), f(pose.qx), f(pose.qy), f(pose.qz), f(pose.qw)};
}

std::optional<TrajectoryPose> TrajectoryReader::next() {
  return first_ ? std::exchange(first_, std::nullopt) : read();
}

std::optional<std::int64_t> TrajectoryReader::first_time_ns() {
  first_ = read();
  return first_ ? std::optional(first_->time_ns) : std::nullopt;
}

std::optional<TrajectoryPose> TrajectoryReader::read() {
  while (const auto text = source_.next()) {
    Fields fields(source_, *text);
    if (fields.at_end() || text->starts_with('#')) continue;
    const TrajectoryPose pose = read_pose(fields);
    if (last_time_ns_ && pose.time_ns < *last_time_ns_)
      source_.fail("the time goes back; expected no less than that of the pose before");
    last_time_ns_ = pose.time_ns;
    return pose;
  }
  if (!last_time_ns_) throw BadInput(path() + ": no pose; expected at least one line of time tx ty tz qx qy qz qw");
  return std::nullopt;
}

std::optional<Pose> parse_pose(std::string_view line) {
  constexpr std::string_view blanks = " \t\r";
  std::array<float, 7> numbers{};
  std::optional<std::int64_t> time_ns;
  std::size_t words = 0;
  for (std::size_t at = 0; (at = line.find_first_not_of(blanks, at)) != line.npos; ++words) {
    const std::size_t end = std::min(line.find_first_of(blanks, at), line.size());
    const std::string_view word = line.substr(at, end - at);
    at = end;
    if (words == 0) {
      time_ns = parse_time_ns(word);
      continue;
    }
    const auto number = parse_number<double>(word);
    if (!number || words > numbers.size()) return std::nullopt;
    numbers[words - 1] = static_cast<float>(*number);
  }
  if (!time_ns || words != 1 + numbers.size()) return std::nullopt;
  const auto& [x, y, z, qx, qy, qz, qw] = numbers;
  if (upward(static_cast<double>(qx), static_cast<double>(qy)) < 0) return std::nullopt;
  return Pose{*time_ns, x, y, z, qx, qy, qz, qw};
}

void write_trajectory_pose(std::ostream& out, const TrajectoryPose& pose) {
  std::string line = seconds(pose.time_ns, 9);
  for (const double metres : {pose.x_m, pose.y_m, pose.z_m}) line += " " + decimals(metres, 6);
  for (const double part : {pose.qx, pose.qy, pose.qz, pose.qw}) line += " " + decimals(part, 9);
  out << line << '\n';
}

}  // namespace curbline::tools
