// The common main() of all programs.
#pragma once

#include <CLI/CLI.hpp>

namespace curbline::tools {

/// Parses the command line, which runs the callback of the program or of its command; adds --version and, in the help,
/// the exit statuses. Returns the exit status: 0; 1 for bad input or a standard output that cannot be written, with one
/// line on standard error; 2 for wrong usage. A signal that ends the program leaves no half-written file.
int run_program(CLI::App& app, int argc, char** argv);

}  // namespace curbline::tools
