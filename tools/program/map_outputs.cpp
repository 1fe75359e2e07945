#include "program/map_outputs.hpp"

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "formats/atomic_file.hpp"
#include "formats/csv.hpp"

namespace curbline::tools {

std::vector<NamedFile> outputs_of(const MapOptions& options) {
  std::vector<NamedFile> files{{"--labels", options.labels}, {"--picture", options.picture}};
  if (options.curbs != "-") files.push_back({"--curbs", options.curbs});
  return files;
}

void check_map_outputs(const MapOptions& options) {
  if (!options.picture.empty()) check_picture_name(options.picture);
  check_writable(outputs_of(options));
}

void give_out(const MapOptions& options, const Map& map, const PictureExtras& picture, nlohmann::json summary) {
  std::optional<AtomicFile> labels, curbs, drawn;
  if (!options.labels.empty()) write_labels(labels.emplace(options.labels).stream(), map);
  if (!options.curbs.empty() && options.curbs != "-") write_curbs(curbs.emplace(options.curbs).stream(), map.curbs);
  if (!options.picture.empty()) draw_picture(map, drawn.emplace(options.picture), picture);
  // Each is written beside its target, which it replaces only after all could be written.
  for (auto* file : {&labels, &curbs, &drawn}) {
    if (*file) (*file)->flush();
  }
  for (auto* file : {&labels, &curbs, &drawn}) {
    if (*file) (*file)->commit();
  }
  if (options.curbs == "-") {
    for (const MapCurb& curb : map.curbs) write_curb_json(std::cout, curb);
  }
  if (options.json) {
    summary["cells"] =
        std::count_if(map.cells.begin(), map.cells.end(), [](const MapCell& cell) { return cell.points > 0; });
    summary["planes"] = map.planes.size();
    summary["curbs"] = map.curbs.size();
    std::cout << summary.dump() << '\n';
  }
}

}  // namespace curbline::tools
