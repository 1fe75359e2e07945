#include <unistd.h>

#include <iostream>
#include <limits>
#include <memory>

#include "command_line/checks.hpp"
#include "program/commands.hpp"
#include "simulator/scene.hpp"
#include "simulator/simulate.hpp"

namespace curbline::tools {
void add_simulate(CLI::App& app) {
  struct Options {
    std::string scene, robot, out;
    SimulationOptions simulation;
  };
  auto* command = app.add_subcommand("simulate", "A scene to scan lines, CAN log, poses and truth");
  auto o = std::make_shared<Options>();
  command
      ->add_option("--scene", o->scene,
                   "a scene that ships, by its name below, a scene file (TOML), or a random street: random:SEED, "
                   "random-drive:SEED")
      ->check(not_empty("a scene"))
      ->required();
  command->add_option("--robot", o->robot, "robot description (TOML)")->check(file_name())->required();
  command
      ->add_option(
          "--out", o->out,
          "directory to write scans.carmen, can.log, poses.tum (of a robot that drives), truth.json, regions.gt, "
          "robot.toml and scene.toml to; the files of an earlier run in it, those that replay left there too, are "
          "replaced")
      ->check(file_name())
      ->required();
  command->add_option("--seed", o->simulation.seed, "of the noise, a whole number")
      ->check(whole_number())
      ->capture_default_str();
  command
      ->add_option("--duration", o->simulation.duration_s,
                   "seconds; without: one nod, or the whole way of a robot that drives")
      ->check(within(std::numeric_limits<double>::min(), longest_s, "seconds above 0, at most a day"));
  command->footer([] {
    std::string names;
    for (const std::string& name : shipped_scenes()) names += " " + name;
    return "Scenes that ship:" + names;
  });
  command->callback([o] {
    const SimulationSummary summary = simulate(find_scene(o->scene), o->robot, o->out, o->simulation);
    if (::isatty(STDERR_FILENO) == 0) return;
    std::cerr << o->out << ": " << summary.lines << " scan lines, " << summary.tilt_frames << " tilt frames, "
              << summary.poses << " poses in " << summary.duration_s << " s\n";
  });
}

}  // namespace curbline::tools
