// The options common to map and replay.
#pragma once

#include <CLI/CLI.hpp>

#include "program/map_options.hpp"

namespace curbline::tools {

/// Only --method; without it `method` is unchanged.
void add_method_option(CLI::App& command, MapMethod& method);

/// Adds the shared options to a command.
void add_map_options(CLI::App& command, MapOptions& options);

}  // namespace curbline::tools
