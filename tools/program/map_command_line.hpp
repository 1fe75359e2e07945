// The options that map and replay have in common.
#pragma once

#include <CLI/CLI.hpp>

#include "program/map_options.hpp"

namespace curbline::tools {

/// --method alone; `method` stays as it is without it.
void add_method_option(CLI::App& command, MapMethod& method);

/// Adds the shared options to a command.
void add_map_options(CLI::App& command, MapOptions& options);

}  // namespace curbline::tools
