// Finds files that ship with curbline, scenes and robots, by name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace curbline::tools {

/// Folders that may contain files of a kind ("scenes", "robots"): that installed beside the program, and that in the
/// source tree.
std::vector<std::filesystem::path> shipped_folders(const std::string& kind);

/// The path of KIND/NAME.toml in the first of these folders that has it; otherwise empty.
std::string shipped_file(const std::string& kind, const std::string& name);

}  // namespace curbline::tools
