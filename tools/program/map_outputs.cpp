#include "program/map_outputs.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "formats/atomic_file.hpp"
#include "formats/csv.hpp"

namespace curbline::tools {

std::vector<NamedFile> outputs_of(const MapOptions& options) {
  std::vector<NamedFile> files{{"--labels", options.labels}, {"--picture", options.picture}};
  if (options.curbs != "-") files.push_back({"--curbs", options.curbs});
  return files;
}

void give_out(const MapOptions& options, const Map& map, const PictureExtras& picture, nlohmann::json summary) {
  // Everything is first written beside its target, which it replaces only after all of it could be written.
  std::unique_ptr<AtomicFile> labels, curbs;
  if (!options.labels.empty()) {
    labels = std::make_unique<AtomicFile>(options.labels);
    write_labels(labels->stream(), map);
  }
  if (!options.curbs.empty() && options.curbs != "-") {
    curbs = std::make_unique<AtomicFile>(options.curbs);
    write_curbs(curbs->stream(), map.curbs);
  }
  if (labels) labels->flush();
  if (curbs) curbs->flush();
  if (!options.picture.empty()) draw_picture(map, options.picture, picture);
  if (labels) labels->commit();
  if (curbs) curbs->commit();
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
