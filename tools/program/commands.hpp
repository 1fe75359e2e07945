// The program's commands. Each adds itself to the command line and runs when it is selected.
#pragma once

#include <CLI/CLI.hpp>

namespace curbline::tools {

void add_simulate(CLI::App& app);
void add_replay(CLI::App& app);
void add_map(CLI::App& app);
void add_evaluate(CLI::App& app);
void add_dbc(CLI::App& app);

}  // namespace curbline::tools
