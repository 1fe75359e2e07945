#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "command_line/checks.hpp"
#include "formats/bad_input.hpp"
#include "formats/cloud.hpp"
#include "formats/decimals.hpp"
#include "program/commands.hpp"
#include "program/map_cloud.hpp"
#include "program/map_command_line.hpp"
#include "program/map_outputs.hpp"
#include "streams/host_pipeline.hpp"

namespace curbline::tools {
namespace {

std::string span(double from_m, double to_m) {
  return readable(from_m, 3) + " to " + readable(to_m, 3);
}

/// Throws BadInput unless a point lies in the window: an empty map would mean that nothing is there.
void check_seen(const std::string& file, std::span<const Point3> cloud, const Bounds& window,
                std::optional<double> max_height_m) {
  const auto inside = [&](const Point3& p) {
    return p.x >= window.x0 && p.x < window.x1 && p.y >= window.y0 && p.y < window.y1 &&
           p.z <= max_height_m.value_or(p.z);
  };
  if (std::any_of(cloud.begin(), cloud.end(), inside)) return;
  const auto extent = [&](double Point3::*axis) {
    const auto [low, high] = std::ranges::minmax(cloud, {}, axis);
    return span(low.*axis, high.*axis);
  };
  throw BadInput(file + ": no point within x " + span(window.x0, window.x1) + ", y " + span(window.y0, window.y1) +
                 (max_height_m ? ", z up to " + decimals(*max_height_m, 3) : "") +
                 " m; expected some: the cloud has x " + extent(&Point3::x) + ", y " + extent(&Point3::y) + ", z " +
                 extent(&Point3::z));
}

}  // namespace

void add_map(CLI::App& app) {
  auto* command = app.add_subcommand("map", "One cloud to labels and curbs, at once");
  struct Options {
    std::string cloud;
    MapOptions map;
  };
  auto o = std::make_shared<Options>();
  command
      ->add_option("cloud", o->cloud,
                   "point cloud, metres, in the frame of its laser or of a robot's base: .xyz .csv .pcd .bin; points "
                   "that are not finite are passed over")
      ->check(file_name())
      ->required();
  add_map_options(*command, o->map);
  command->callback([o] {
    check_outputs(outputs_of(o->map), {{"the cloud", o->cloud}});
    check_map_outputs(o->map);
    const std::vector<Point3> cloud = read_cloud(o->cloud);
    const Map map = map_cloud(cloud, o->map);
    check_seen(o->cloud, cloud, map.grid.bounds(), o->map.max_height_m);
    give_out(o->map, map, {.title = o->cloud, .robot = RobotMarker{}}, {{"points", cloud.size()}});
  });
}

}  // namespace curbline::tools
