// The files that a command is to read and to write, before it reads any.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace curbline::tools {

/// A file and the option that names it; an empty path: none.
struct NamedFile {
  std::string option, path;
};

/// What an option that names a file or a directory is checked with: an empty name, as a shell's unset variable gives,
/// would be taken for none.
CLI::Validator file_name();
CLI::Validator not_empty(const std::string& expected);  ///< the same, for other names

/// Throws CLI::ValidationError unless each output is a name, and a file that is neither an input nor another output.
void check_outputs(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs);

}  // namespace curbline::tools
