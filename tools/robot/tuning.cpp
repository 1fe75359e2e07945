#include "robot/parts.hpp"

#include "curbline/map/dem.hpp"
#include "curbline/setting_ranges.hpp"

namespace curbline::tools {
namespace {

namespace ranges = setting_ranges;

void read_segmentation(TomlTable table, SegmentationSettings& segmentation) {
  table.read("cell_degrees", segmentation.cell.degrees, ranges::degrees);
  table.read("cell_variance_m2", segmentation.cell.variance_m2, ranges::variance_m2);
  table.read("leaf_scale", segmentation.leaf_scale, ranges::leaf_scale);
  table.read_whole("link_reach", segmentation.link_reach, 1, max_link_reach);
  table.done();
}

void read_planes(TomlTable table, PlaneSettings& planes) {
  Range noise_m2 = ranges::variance_m2;
  if (!table.has("texture_m2")) noise_m2.lowest = planes.prior.texture_m2;  // which is a part of it
  table.read("noise_m2", planes.prior.noise_m2, noise_m2);
  table.read("texture_m2", planes.prior.texture_m2, {0.0, planes.prior.noise_m2});
  table.read("common_share", planes.prior.common_share, ranges::common_share);
  table.read("curvature_1_m", planes.prior.curvature_1_m, ranges::curvature_1_m);
  table.read("degrees", planes.prior.degrees, ranges::noise_degrees);
  table.read("min_cells", planes.min_cells, ranges::min_cells);
  std::string update = planes.update == PlaneUpdate::regions ? "regions" : "responsibilities";
  table.read("update", update);
  if (update != "regions" && update != "responsibilities") {
    table.refuse_word("update", update, "regions or responsibilities");
  }
  planes.update = update == "regions" ? PlaneUpdate::regions : PlaneUpdate::responsibilities;
  table.done();
}

void read_labels(TomlTable table, LabelSettings& labels) {
  table.read("coupling", labels.coupling, ranges::coupling);
  table.read_whole("link_reach", labels.link_reach, 1, max_link_reach);
  if (table.has("max_messages")) table.read_whole("max_messages", labels.max_messages.emplace(), 4, 100'000'000);
  table.done();
}

void read_curbs(TomlTable table, CurbSettings& curbs) {
  table.read_whole("link_reach", curbs.link_reach, 1, max_link_reach);
  table.read("max_step_m", curbs.max_step_m, ranges::max_step_m);
  table.done();
}

}  // namespace

void read_tuning(TomlTable table, Robot& robot) {
  read_segmentation(table.table("segmentation"), robot.segmentation);
  read_planes(table.table("planes"), robot.planes);
  read_labels(table.table("labels"), robot.labels);
  read_curbs(table.table("curbs"), robot.curbs);
  table.done();
}

}  // namespace curbline::tools
