#include "simulator/scene.hpp"

#include "formats/bad_input.hpp"
#include "formats/shipped.hpp"

#include <algorithm>
#include <filesystem>
#include <set>

namespace curbline::tools {

namespace fs = std::filesystem;

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
  if (const std::string file = shipped_file("scenes", name_or_path); !file.empty()) {
    return read_scene(file);
  }
  std::string known;
  for (const std::string& name : shipped_scenes()) {
    known += " " + name;
  }
  throw BadInput("no scene '" + name_or_path + "'; expected a file or one of:" + known);
}

int region_at(const std::vector<GroundRegion>& regions, Point2 p) {
  const auto top =
      std::find_if(regions.rbegin(), regions.rend(), [p](const GroundRegion& region) { return region.holds(p); });
  return static_cast<int>(regions.rend() - top) - 1;
}

}  // namespace curbline::tools
