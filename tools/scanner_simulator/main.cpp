// curbline-scanner: a simulated laser scanner that drivers can connect to.
#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <iostream>
#include <memory>
#include <optional>

#include "cola/session.hpp"
#include "command_line/checks.hpp"
#include "command_line/run_program.hpp"
#include "scanner_simulator/server.hpp"
#include "scip2/session.hpp"

namespace curbline::tools {
namespace {

std::atomic<bool> stopped = false;

void stop(int) {
  stopped = true;
}

struct Options {
  std::string protocol, scans, scene, robot, speed = "1";
  std::optional<std::uint16_t> port;
};

Protocol protocol_of(const std::string& name) {
  return name == "scip2" ? Protocol::scip2 : name == "cola" ? Protocol::cola : Protocol::lms200;
}

std::uint16_t port_of(const Options& o) {
  return o.port.value_or(o.protocol == "scip2" ? scip2::tcp_port : cola::tcp_port);
}

void run(const Options& o) {
  const double speed = parse_speed(o.speed);
  if (o.scene.empty() == o.scans.empty()) throw CLI::ValidationError("--scene", "expected it or --scans, and not both");
  if (o.scene.empty() != o.robot.empty())
    throw CLI::ValidationError("--robot", "expected it with --scene, and only there");
  if (o.port && o.protocol == "lms200")
    throw CLI::ValidationError("--port", "expected it with scip2 or cola; an LMS-200 has a serial line");
  ScanFeed feed =
      o.scene.empty() ? ScanFeed::from_log(o.scans) : ScanFeed::from_scene(find_scene(o.scene), read_robot(o.robot));
  ServerOptions options;
  options.port = port_of(o);
  options.speed = speed;
  ScannerServer server(protocol_of(o.protocol), std::move(feed), o.scene.empty() ? o.scans : o.robot, options);
  std::signal(SIGINT, stop);
  std::signal(SIGTERM, stop);
  if (!(std::cout << server.address() << std::endl)) return;  // which run_program() tells
  server.run(stopped);
}

}  // namespace
}  // namespace curbline::tools

int main(int argc, char** argv) {
  using namespace curbline::tools;
  CLI::App app(
      "Plays scan lines as a laser scanner does, over its own protocol. Prints what `curbline replay --scans` takes.",
      "curbline-scanner");
  auto o = std::make_shared<Options>();
  app.add_option("protocol", o->protocol, "scip2 (UTM-30LX), cola (LMS151) or lms200")
      ->required()
      ->check(CLI::IsMember({"scip2", "cola", "lms200"}));
  app.add_option("--scans", o->scans, "scan lines, CARMEN log")->check(file_name());
  app.add_option(
         "--scene", o->scene,
         "a scene that ships, by its name, or a scene file (TOML): its lines are those that `curbline simulate` writes")
      ->check(not_empty("a scene"));
  app.add_option("--robot", o->robot, "robot description (TOML), for --scene")->check(file_name());
  app.add_option("--port", o->port, "TCP port on the loopback interface; 0: any (10940 for scip2, 2112 for cola)")
      ->check(whole_number(0, 65535));
  app.add_option("--speed", o->speed, "times as fast as the lines' own time, or max: as fast as they are read")
      ->check(speed())
      ->capture_default_str();
  app.callback([o] { run(*o); });
  return run_program(app, argc, argv);
}
