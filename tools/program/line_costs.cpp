#include "program/line_costs.hpp"

#include "formats/decimals.hpp"

namespace curbline::tools {
namespace {

std::uint32_t full(const Counters& c) {
  return c.regions_full + c.links_full + c.planes_full + c.borders_full + c.curbs_full;
}

}  // namespace

LineCosts::LineCosts(const std::string& path) : file_(path) {
  file_.stream() << "x_m,y_m,take_s,evidences,messages,dropped,full,deferred\n";
}

void LineCosts::add(const Replay& replay) {
  const Counters now = replay.pipeline().counters();
  const RobotMarker robot = replay.robot();
  file_.stream() << decimals(robot.x_m, 3) << ',' << decimals(robot.y_m, 3) << ',' << decimals(replay.take_s(), 7)
                 << ',' << now.evidences - before_.evidences << ',' << now.messages - before_.messages << ','
                 << now.lines_dropped - before_.lines_dropped << ',' << full(now) - full(before_) << ','
                 << now.cells_deferred - before_.cells_deferred << '\n';
  before_ = now;
}

}  // namespace curbline::tools
