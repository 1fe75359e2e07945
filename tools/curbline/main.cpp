// curbline: simulate, replay, map, evaluate, dbc.
#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "curbline/commands.hpp"
#include "formats/bad_input.hpp"

int main(int argc, char** argv) {
  using namespace curbline::tools;
  CLI::App app("Finds curbs in the scan lines of a nodding laser.", "curbline");
  app.require_subcommand(1);
  add_simulate(app);
  add_replay(app);
  add_map(app);
  add_evaluate(app);
  add_dbc(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const BadInput& error) {
    std::cerr << error.what() << '\n';
    return 1;
  } catch (const std::exception& error) {
    std::cerr << "curbline: " << error.what() << '\n';
    return 1;
  }
  if (!std::cout.flush()) {
    std::cerr << "standard output: cannot be written\n";
    return 1;
  }
  return 0;
}
