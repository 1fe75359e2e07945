#include "program/map_outputs.hpp"

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "formats/csv.hpp"

namespace curbline::tools {

std::vector<NamedFile> outputs_of(const MapOptions& options) {
  std::vector<NamedFile> files{{"--labels", options.labels}, {"--picture", options.picture}};
  if (options.curbs != "-") files.push_back({"--curbs", options.curbs});
  return files;
}

MapOutputs::MapOutputs(const MapOptions& options) : options_(options) {
  if (!options.picture.empty()) check_picture_name(options.picture);
  if (!options.labels.empty()) labels_.emplace(options.labels);
  if (!options.curbs.empty() && options.curbs != "-") curbs_.emplace(options.curbs);
  if (!options.picture.empty()) picture_.emplace(options.picture);
}

void MapOutputs::give_out(const Map& map, const PictureExtras& picture, nlohmann::json summary) {
  if (labels_) write_labels(labels_->stream(), map);
  if (curbs_) write_curbs(curbs_->stream(), map.curbs);
  if (picture_) draw_picture(map, *picture_, picture);
  // Each is written beside its target, which it replaces only after all could be written.
  for (auto* file : {&labels_, &curbs_, &picture_}) {
    if (*file) (*file)->flush();
  }
  for (auto* file : {&labels_, &curbs_, &picture_}) {
    if (*file) (*file)->commit();
  }
  if (options_.curbs == "-") {
    for (const MapCurb& curb : map.curbs) write_curb_json(std::cout, curb);
  }
  if (options_.json) {
    summary["cells"] =
        std::count_if(map.cells.begin(), map.cells.end(), [](const MapCell& cell) { return cell.points > 0; });
    summary["planes"] = map.planes.size();
    summary["curbs"] = map.curbs.size();
    std::cout << summary.dump() << '\n';
  }
}

}  // namespace curbline::tools
