#include <memory>

#include "curbline/commands.hpp"
#include "curbline/host_pipeline.hpp"
#include "curbline/map_cloud.hpp"
#include "curbline/map_options.hpp"
#include "formats/cloud.hpp"

namespace curbline::tools {

void add_map(CLI::App& app) {
  auto* command = app.add_subcommand("map", "One cloud at once");
  struct Options {
    std::string cloud;
    MapOptions map;
  };
  auto o = std::make_shared<Options>();
  command->add_option("cloud", o->cloud, "point cloud: .xyz .csv .pcd .bin")->required();
  add_map_options(*command, o->map);
  command->callback([o] {
    check_outputs(outputs_of(o->map), {{"the cloud", o->cloud}});
    const std::vector<Point3> cloud = read_cloud(o->cloud);
    const Map map = map_cloud(cloud, o->map);
    give_out(o->map, map, {.title = o->cloud, .truth = {}, .robot = RobotMarker{}}, {{"points", cloud.size()}});
  });
}

}  // namespace curbline::tools
