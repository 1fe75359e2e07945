// Whether there is a file, where its absence is no error.
#pragma once

#include <filesystem>
#include <string>

namespace curbline::tools {

/// False too for a name that is too long, and in a folder that may not be entered: std::filesystem::exists() throws
/// there, and who opens the file says better what is wrong.
inline bool file_exists(const std::filesystem::path& path) {
  std::error_code none;
  return std::filesystem::exists(path, none);
}

}  // namespace curbline::tools
