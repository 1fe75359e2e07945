// Common to the simulator's tests: scenes from text, and paths that are removed when the test ends.
#pragma once

#include "simulator/scene.hpp"

#include <unistd.h>
#include <filesystem>
#include <string>

namespace curbline::tools {

/// A path that only this process uses, removed at the end.
struct TemporaryPath {
  std::filesystem::path path;
  explicit TemporaryPath(const std::string& name)
      : path(std::filesystem::temp_directory_path() / ("curbline_" + std::to_string(getpid()) + "_" + name)) {}
  ~TemporaryPath() { std::filesystem::remove_all(path); }
};

inline Scene scene_of(const std::string& text) {
  return parse_scene(text, "scene.toml");
}

}  // namespace curbline::tools
