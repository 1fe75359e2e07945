#include "robot/parts.hpp"

#include "curbline/map/dem.hpp"

namespace curbline::tools {
namespace {

void read_segmentation(TomlTable table, SegmentationSettings& segmentation) {
  table.read("cell_degrees", segmentation.cell.degrees, {1e-3, 1e6});
  table.read("cell_variance_m2", segmentation.cell.variance_m2, {1e-10, 100.0});
  table.read("leaf_scale", segmentation.leaf_scale, {1e-3, 1e6});
  table.read_whole("link_reach", segmentation.link_reach, 1, max_link_reach);
  table.done();
}

void read_planes(TomlTable table, PlaneSettings& planes) {
  const double least_noise_m2 = table.has("texture_m2") ? 1e-10 : planes.prior.texture_m2;  // of which it is a part
  table.read("noise_m2", planes.prior.noise_m2, {least_noise_m2, 100.0});
  table.read("texture_m2", planes.prior.texture_m2, {0.0, planes.prior.noise_m2});
  table.read("common_share", planes.prior.common_share, {0.01, 1.0});
  table.read("curvature_1_m", planes.prior.curvature_1_m, {0.0, 10.0});
  table.read("degrees", planes.prior.degrees, {1.0, 1e6});
  table.read("min_cells", planes.min_cells, {3.0, 1e6});
  std::string update = planes.update == PlaneUpdate::regions ? "regions" : "responsibilities";
  table.read("update", update);
  if (update != "regions" && update != "responsibilities") {
    table.refuse_word("update", update, "regions or responsibilities");
  }
  planes.update = update == "regions" ? PlaneUpdate::regions : PlaneUpdate::responsibilities;
  table.done();
}

void read_labels(TomlTable table, LabelSettings& labels) {
  table.read("coupling", labels.coupling, {0.01, 7.9});
  table.read_whole("link_reach", labels.link_reach, 1, max_link_reach);
  if (table.has("max_messages")) table.read_whole("max_messages", labels.max_messages.emplace(), 4, 100'000'000);
  table.done();
}

void read_curbs(TomlTable table, CurbSettings& curbs) {
  table.read_whole("link_reach", curbs.link_reach, 1, max_link_reach);
  table.read("max_step_m", curbs.max_step_m, {1e-3, 10.0});
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
