#include <iostream>
#include <memory>

#include "command_line/checks.hpp"
#include "formats/dbc.hpp"
#include "program/commands.hpp"
#include "robot/signal_dbc.hpp"

namespace curbline::tools {
namespace {

struct Options {
  std::string file, message, signal, robot;
  bool curbs = false;
};

void run(const Options& o) {
  if (!o.robot.empty()) {
    write_dbc(std::cout, dbc_of(read_robot(o.robot)));
  } else if (o.curbs) {
    write_dbc(std::cout, curb_dbc());
  } else if (o.signal.empty()) {
    throw CLI::ValidationError("dbc", "expected FILE MESSAGE SIGNAL, --robot ROBOT.toml or --curbs");
  } else {
    std::cout << tilt_toml(find_signal(read_dbc(o.file), o.file, o.message, o.signal),
                           o.message + "." + o.signal + " of " + o.file);
  }
}

}  // namespace

void add_dbc(CLI::App& app) {
  auto* command = app.add_subcommand("dbc", "A tilt signal of a DBC file as TOML, or a robot's as DBC, on stdout");
  auto o = std::make_shared<Options>();
  auto* file = command->add_option("FILE", o->file, "DBC file: prints [tilt.signal] for a robot description")
                   ->check(file_name());
  auto* message = command->add_option("MESSAGE", o->message, "of the file");
  auto* signal = command->add_option("SIGNAL", o->signal, "of the message: the tilt angle");
  auto* robot = command->add_option("--robot", o->robot, "robot description (TOML): prints the DBC of its tilt signal")
                    ->check(file_name());
  auto* curbs = command->add_flag("--curbs", o->curbs, "prints the DBC of the frames that say what curb is ahead");
  for (auto* part : {file, message, signal}) part->excludes(robot)->excludes(curbs);
  robot->excludes(curbs);
  command->callback([o] { run(*o); });
}

}  // namespace curbline::tools
