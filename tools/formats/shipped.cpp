#include "formats/shipped.hpp"

#include "formats/file_exists.hpp"

namespace curbline::tools {

namespace fs = std::filesystem;

std::vector<fs::path> shipped_folders(const std::string& kind) {
  std::vector<fs::path> folders;
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  if (!failed) folders.push_back(program.parent_path().parent_path() / "share/curbline" / kind);
  folders.push_back(fs::path(CURBLINE_TOOLS_FOLDER) / kind);
  return folders;
}

std::string shipped_file(const std::string& kind, const std::string& name) {
  for (const fs::path& folder : shipped_folders(kind)) {
    const fs::path file = folder / (name + ".toml");
    if (file_exists(file)) return file.string();
  }
  return {};
}

}  // namespace curbline::tools
