// What the main() of every program does.
#pragma once

#include <CLI/CLI.hpp>

namespace curbline::tools {

/// Reads the command line, which runs the callback of the program or of its command; --version and, in the help, the
/// exit statuses are added. Returns the exit status: 0, 1 for bad input or a standard output that cannot be written,
/// with one line on standard error, or 2 for wrong usage. A signal that ends the program leaves nothing half-written.
int run_program(CLI::App& app, int argc, char** argv);

}  // namespace curbline::tools
