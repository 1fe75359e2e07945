#include <unistd.h>

#include <charconv>
#include <cstdint>
#include <iostream>
#include <memory>

#include "curbline/commands.hpp"
#include "curbline/outputs.hpp"
#include "formats/decimals.hpp"
#include "simulator/scene.hpp"
#include "simulator/simulate.hpp"

namespace curbline::tools {
namespace {

/// Of 64 bits. CLI11 takes -1 for the greatest.
CLI::Validator whole_number() {
  const auto check = [](const std::string& text) {
    std::uint64_t value = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool good = problem == std::errc{} && end == text.data() + text.size();
    return good ? "" : text + "; expected a whole number from 0 to 18446744073709551615";
  };
  return CLI::Validator(check, "");
}

}  // namespace

void add_simulate(CLI::App& app) {
  struct Options {
    std::string scene, robot, out;
    SimulationOptions simulation;
  };
  auto* command = app.add_subcommand("simulate", "A scene to scan lines, CAN log, poses and truth");
  auto o = std::make_shared<Options>();
  command
      ->add_option("--scene", o->scene,
                   "a scene that ships, by its name below, a scene file (TOML), or streets drawn by lot: random:SEED, "
                   "random-drive:SEED")
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
  command->add_option("--duration", o->simulation.duration_s,
                      "seconds; without: one nod, or the whole way of a robot that drives");
  command->footer([] {
    std::string names;
    for (const std::string& name : shipped_scenes()) names += " " + name;
    return "Scenes that ship:" + names;
  });
  command->callback([o] {
    const double duration_s = o->simulation.duration_s.value_or(1.0);
    if (!(duration_s > 0 && duration_s <= longest_s)) {
      throw CLI::ValidationError("--duration", shortest(duration_s) + "; expected seconds above 0, at most a day");
    }
    const SimulationSummary summary = simulate(find_scene(o->scene), o->robot, o->out, o->simulation);
    if (::isatty(STDERR_FILENO) == 0) return;
    std::cerr << o->out << ": " << summary.lines << " scan lines, " << summary.tilt_frames << " tilt frames, "
              << summary.poses << " poses in " << summary.duration_s << " s\n";
  });
}

}  // namespace curbline::tools
