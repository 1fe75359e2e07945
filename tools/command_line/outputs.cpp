#include "command_line/outputs.hpp"

#include <CLI/Error.hpp>
#include <filesystem>

#include "formats/atomic_file.hpp"

namespace curbline::tools {
namespace {

namespace fs = std::filesystem;

/// Whether two names, including links, refer to the same file. Devices and pipes may be written more than once.
bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code none;
  if (a.empty() || b.empty()) return false;
  if (!fs::exists(a, none) || !fs::exists(b, none)) {
    return fs::weakly_canonical(fs::absolute(a, none), none) == fs::weakly_canonical(fs::absolute(b, none), none);
  }
  return fs::is_regular_file(a, none) && fs::equivalent(a, b, none);
}

void check_apart(const NamedFile& output, const NamedFile& other) {
  if (same_file(output.path, other.path))
    throw CLI::ValidationError(output.option, output.path + " is also " + other.option + "; expected another file");
}

}  // namespace

void check_outputs(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs) {
  for (auto output = outputs.begin(); output != outputs.end(); ++output) {
    if (output->path == "-")
      throw CLI::ValidationError(output->option, "-; expected a file name: standard output is not for it");
    for (const NamedFile& input : inputs) check_apart(*output, input);
    for (auto before = outputs.begin(); before != output; ++before) check_apart(*output, *before);
  }
}

void check_writable(const std::vector<NamedFile>& outputs) {
  for (const NamedFile& output : outputs) {
    std::error_code none;
    if (!output.path.empty() && !fs::is_other(fs::status(output.path, none))) AtomicFile file(output.path);
  }
}

}  // namespace curbline::tools
