// curbline-drive-log: converts logs to a board's input, and a board's output to curbs.
#include <CLI/CLI.hpp>
#include <iostream>

#include "command_line/checks.hpp"
#include "command_line/outputs.hpp"
#include "command_line/run_program.hpp"
#include "drive_streams/drive_streams.hpp"
#include "formats/csv.hpp"

int main(int argc, char** argv) {
  using namespace curbline::tools;
  CLI::App app("Makes the stream that boards are fed, and reads their results.", "curbline-drive-log");
  app.require_subcommand(1);
  DriveFiles files;
  auto* write = app.add_subcommand("write", "Logs to a stream");
  write->add_option("--robot", files.robot, "robot description (TOML)")->check(file_name())->required();
  write->add_option("--scans", files.logs.scans, "scan lines, CARMEN log")->check(file_name())->required();
  write->add_option("--can", files.logs.can, "tilt frames, candump log; none for a fixed tilt")->check(file_name());
  write->add_option("--poses", files.logs.poses, "robot poses, TUM trajectory; none if the robot stands")
      ->check(file_name());
  write->add_option("--out", files.out, "file to write: the stream")->check(file_name())->required();
  write->callback([&] {
    check_outputs({{"--out", files.out}}, {{"--robot", files.robot},
                                           {"--scans", files.logs.scans},
                                           {"--can", files.logs.can},
                                           {"--poses", files.logs.poses}});
    if (const std::string remarks = write_drive(files); !remarks.empty()) std::cerr << remarks << '\n';
  });
  std::string results;
  auto* curbs = app.add_subcommand("curbs", "Results to the curbs after the last scan line, as CSV on stdout");
  curbs->add_option("RESULTS", results, "file of what a board gave back")->check(file_name())->required();
  curbs->callback([&] { write_curbs(std::cout, read_last_curbs(results)); });
  return run_program(app, argc, argv);
}
