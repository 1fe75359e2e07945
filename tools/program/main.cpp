// curbline: simulate, replay, map, evaluate, dbc.
#include "command_line/run_program.hpp"
#include "program/commands.hpp"

int main(int argc, char** argv) {
  using namespace curbline::tools;
  CLI::App app("Finds curbs in the scan lines of a nodding laser.", "curbline");
  app.require_subcommand(1);
  add_simulate(app);
  add_replay(app);
  add_map(app);
  add_evaluate(app);
  add_dbc(app);
  return run_program(app, argc, argv);
}
