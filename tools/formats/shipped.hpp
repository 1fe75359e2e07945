// Files that come with curbline: scenes and robots by their name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace curbline::tools {

/// Where files of a kind ("scenes", "robots") may lie: where they were installed beside the program, and in the source
/// tree.
std::vector<std::filesystem::path> shipped_folders(const std::string& kind);

/// The path of KIND/NAME.toml in the first of these folders that has it; empty if none has.
std::string shipped_file(const std::string& kind, const std::string& name);

}  // namespace curbline::tools
