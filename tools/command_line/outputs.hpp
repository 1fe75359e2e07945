// Checks the files that a command will read and write, before it reads any.
#pragma once

#include <string>
#include <vector>

namespace curbline::tools {

/// A file and the option that names it; an empty path means none.
struct NamedFile {
  std::string option, path;
};

/// Throws CLI::ValidationError unless each output is a name, and a file that is neither an input nor another output.
void check_outputs(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs);

/// Throws BadInput if an AtomicFile of that name would: a file that cannot be written is refused before an hour of scan
/// lines, not after. A pipe is not opened, which would wait for its reader.
void check_writable(const std::vector<NamedFile>& outputs);

}  // namespace curbline::tools
