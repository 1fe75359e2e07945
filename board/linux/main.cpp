// curblined: curbs on a running robot. README.md in this folder is its manual.
#include <CLI/CLI.hpp>
#include <csignal>
#include <iostream>
#include <memory>

#include "command_line/checks.hpp"
#include "command_line/run_program.hpp"
#include "daemon.hpp"
#include "robot/robot.hpp"

int main(int argc, char** argv) {
  using namespace curbline;
  CLI::App app(
      "Finds curbs while the robot runs: tilt angles from a CAN interface and scan lines in, curbs out. Runs until "
      "SIGINT, SIGTERM, SIGHUP or the end of a log, then prints its last status.",
      "curblined");
  std::string robot;
  daemon::Options options;
  app.add_option("--robot", robot, "robot description (TOML)")->check(tools::file_name())->required();
  auto* can =
      app.add_option("--can", options.can, "CAN interface of the tilt servo, such as can0; none for a fixed tilt")
          ->check(tools::not_empty("a CAN interface"));
  app.add_option("--scans", options.scans,
                 "a live scanner, scip2:HOST[:PORT], cola:HOST[:PORT] or lms200:DEVICE, or a CARMEN log, played at its "
                 "own times")
      ->check(tools::not_empty("a scanner or a log"))
      ->required();
  app.add_option("--poses", options.poses,
                 "poses of a robot that drives, lines of time tx ty tz qx qy qz qw (TUM): a FIFO that its localisation "
                 "writes to, - for standard input, or the trajectory of a log")
      ->check(tools::not_empty("a FIFO, - or a trajectory"));
  app.add_option("--curbs", options.curbs, "where clients read JSON lines: unix:PATH or tcp:HOST:PORT")
      ->check(tools::not_empty("unix:PATH or tcp:HOST:PORT"))
      ->required();
  app.add_flag("--can-out", options.can_out, "the curb ahead as CAN frames too, those of `curbline dbc --curbs`")
      ->needs(can);
  std::signal(SIGPIPE, SIG_IGN);  // the daemon continues if the reader of standard error closes it
  app.callback([&] {
    tools::Robot description = tools::read_robot(robot);
    if (!options.poses.empty()) description.pose.still = false;
    const auto running = std::make_unique<daemon::Daemon>(description, options);
    running->run();
    std::cout << running->status();
  });
  return tools::run_program(app, argc, argv);
}
