#include "simulator/scene.hpp"

#include "formats/bad_input.hpp"
#include "formats/parse_number.hpp"
#include "formats/shipped.hpp"
#include "simulator/random_street.hpp"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <set>

namespace curbline::tools {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view random_prefix = "random:", drive_prefix = "random-drive:";

Scene random_scene(const std::string& name, std::string_view prefix) {
  const auto seed = parse_number<std::uint64_t>(std::string_view(name).substr(prefix.size()));
  if (!seed) {
    throw BadInput("no scene '" + name + "'; expected " + std::string(prefix) + " and a whole number, the seed");
  }
  return parse_scene(random_street(*seed, prefix == drive_prefix ? StreetRobot::drives : StreetRobot::stands), name);
}

}  // namespace

std::vector<std::string> shipped_scenes() {
  std::set<std::string> names;
  for (const fs::path& folder : shipped_folders("scenes")) {
    std::error_code failed;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
      if (entry.path().extension() == ".toml") {
        names.insert(entry.path().stem().string());
      }
    }
  }
  return {names.begin(), names.end()};
}

Scene find_scene(const std::string& name_or_path) {
  if (name_or_path.find('/') != std::string::npos || name_or_path.ends_with(".toml")) {
    return read_scene(name_or_path);
  }
  for (const std::string_view prefix : {random_prefix, drive_prefix}) {
    if (name_or_path.starts_with(prefix)) {
      return random_scene(name_or_path, prefix);
    }
  }
  if (const std::string file = shipped_file("scenes", name_or_path); !file.empty()) {
    return read_scene(file);
  }
  std::string known;
  for (const std::string& name : shipped_scenes()) {
    known += " " + name;
  }
  throw BadInput("no scene '" + name_or_path + "'; expected a file, random:SEED, random-drive:SEED or one of:" + known);
}

std::vector<Leg> legs(const RobotPath& path) {
  std::vector<Leg> out;
  for (std::size_t i = 1; i < path.waypoints.size(); ++i) {
    const Point2 from = path.waypoints[i - 1], to = path.waypoints[i];
    const double heading = std::atan2(to.y - from.y, to.x - from.x);
    const double yaw_rad = out.empty() ? heading : out.back().to_rad;
    out.push_back({from, to, yaw_rad, yaw_rad + std::remainder(heading - yaw_rad, 2 * std::numbers::pi)});
  }
  return out;
}

}  // namespace curbline::tools
