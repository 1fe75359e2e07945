#include "program/map_command_line.hpp"

#include <algorithm>
#include <limits>

#include "command_line/checks.hpp"

namespace curbline::tools {
namespace {

/// An option with a choice of a few words.
template <typename Choice>
CLI::Option* add_choice(CLI::App& command, const std::string& option, Choice& choice,
                        const CLI::TransformPairs<Choice>& choices, const std::string& help) {
  const auto choose = [&choice, option, choices](const std::string& word) {
    std::string words;
    for (const auto& [name, value] : choices) {
      if (name == word) choice = value;
      words += (words.empty() ? "" : ", ") + name;
    }
    if (std::none_of(choices.begin(), choices.end(), [&](const auto& each) { return each.first == word; }))
      throw CLI::ValidationError(option, word + "; expected one of " + words);
  };
  return command.add_option_function<std::string>(option, choose, help);
}

/// For an option of one or two values, which would also take the values of a second such option; CLI11 puts an empty
/// value between them if told to inject a separator.
CLI::Validator once() {
  return CLI::Validator(
      [](const std::string& text) { return text.empty() ? std::string("given twice, or empty; expected once") : ""; },
      "");
}

}  // namespace

void add_method_option(CLI::App& command, MapMethod& method) {
  add_choice<MapMethod>(
      command, "--method", method,
      {{"curbline", MapMethod::curbline},
       {"crf-em", MapMethod::crf_em},
       {"em", MapMethod::em},
       {"segment", MapMethod::segment},
       {"canny", MapMethod::canny},
       {"gradient", MapMethod::gradient}},
      "curbline (default); the paper's steps: crf-em, em, segment; its peers, curbs alone: canny, gradient");
}

void add_map_options(CLI::App& command, MapOptions& options) {
  const CLI::Validator place = within(-1e9, 1e9, "metres in [-1e9, 1e9]");
  // Without this, an option with a list of numbers would also take the argument after it, the cloud.
  auto* origin =
      command
          .add_option(
              "--origin", options.origin,
              "lowest corner X Y of a fixed window, metres; without it replay has the robot's window, map 40 x 40 "
              "cells from 0 -2")
          ->expected(2)
          ->allow_extra_args(false)
          ->check(place);
  auto* size = command.add_option("--size", options.size, "length of the window along x and along y, metres")
                   ->expected(2)
                   ->allow_extra_args(false);
  origin->needs(size);
  size->needs(origin);
  command.add_option("--cell", options.cell, "side of a cell, or both sides, metres; default: 0.1, or the robot's")
      ->expected(1, 2)
      ->allow_extra_args(false)
      ->check(once())
      ->check(within(0.001, 10, "metres in [0.001, 10]; a cloud comes before --cell, or last"))
      ->inject_separator();
  command
      .add_option("--max-height", options.max_height_m,
                  "points above are ignored, metres; default: none, or the robot's")
      ->check(place);
  add_method_option(command, options.method);
  auto* edge = add_choice<reference::EdgePotential>(
      command, "--edge", options.edge,
      {{"potts", reference::EdgePotential::potts}, {"eq10", reference::EdgePotential::eq10}},
      "edge potential of crf-em: potts (default, factor 10) or eq10; no effect with em and segment");
  auto* scale =
      command
          .add_option("--segment-scale", options.segment_scale, "s of the graph segmentation in crf-em, em and segment")
          ->check(
              within(std::numeric_limits<double>::min(), std::numeric_limits<double>::max(), "a finite number above 0"))
          ->capture_default_str();
  command.add_option("--labels", options.labels, "file to write: CSV, the window's valid cells")->check(file_name());
  command
      .add_option("--curbs", options.curbs,
                  "file to write: CSV, the curbs; -: JSON lines on stdout, from replay as they are found")
      ->check(file_name());
  command.add_option("--picture", options.picture, "file to write: PNG or SVG, by its ending")->check(file_name());
  command.add_flag("--json", options.json, "summary on stdout, a JSON object");
  // Options that the method would ignore are refused.
  command.parse_complete_callback([&options, edge, scale] {
    using enum MapMethod;
    const MapMethod method = options.method;
    if (method == crf_em || method == em || method == segment) return;
    for (const CLI::Option* option : {edge, scale}) {
      if (option->count() > 0)
        throw CLI::ValidationError(option->get_name(), "of another method; expected --method crf-em, em or segment");
    }
  });
}

}  // namespace curbline::tools
