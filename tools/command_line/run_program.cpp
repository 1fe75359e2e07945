#include "command_line/run_program.hpp"

#include <exception>
#include <iostream>

#include "formats/atomic_file.hpp"
#include "formats/bad_input.hpp"

namespace curbline::tools {
namespace {

/// For an unknown command, CLI11 only says that one is required.
void check_command(const CLI::App& app, int argc, char** argv) {
  const auto all = app.get_subcommands({});
  if (all.empty() || argc < 2 || argv[1][0] == '-') return;
  std::string commands;
  for (const CLI::App* command : all) {
    if (command->get_name() == argv[1]) return;
    commands += (commands.empty() ? "" : ", ") + command->get_name();
  }
  throw CLI::ParseError(std::string(argv[1]) + " is no command; expected one of " + commands,
                        CLI::ExitCodes::ExtrasError);
}

}  // namespace

int run_program(CLI::App& app, int argc, char** argv) {
  remove_uncommitted_at_signals();
  app.set_version_flag("--version", app.get_name() + " " CURBLINE_VERSION, "Print the version and exit");
  app.footer(
      "Exit status: 0 done; 1 the input is bad or an output cannot be written, one line on stderr; 2 wrong usage.");
  try {
    check_command(app, argc, argv);
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (app.exit(error) != 0) return 2;  // otherwise it is the help or the version
  } catch (const BadInput& error) {
    std::cerr << error.what() << '\n';
    return 1;
  } catch (const std::exception& error) {
    std::cerr << app.get_name() << ": " << error.what() << '\n';
    return 1;
  }
  if (!std::cout.flush()) {
    std::cerr << "standard output: cannot be written; expected room for it\n";
    return 1;
  }
  return 0;
}

}  // namespace curbline::tools
