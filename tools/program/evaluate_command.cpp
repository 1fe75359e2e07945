#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "command_line/checks.hpp"
#include "program/commands.hpp"
#include "program/evaluate.hpp"
#include "program/map_command_line.hpp"

namespace curbline::tools {

void add_evaluate(CLI::App& app) {
  struct Options {
    EvaluateOptions truth;
    MapMethod method = MapMethod::curbline;
    std::string paper;
    bool json = false;
  };
  auto* command = app.add_subcommand("evaluate", "Scores against truth, as a table on stdout");
  auto o = std::make_shared<Options>();
  auto* dir =
      command
          ->add_option(
              "dir", o->truth.dir,
              "directory that simulate wrote; labels.csv and curbs.csv are scored where both are in it, else, or with "
              "--method, what its logs give")
          ->check(file_name());
  auto* paper =
      command
          ->add_option("--paper", o->paper, "folder of clouds with regions, NAME.xyz and NAME.gt: the paper's tables")
          ->check(file_name());
  dir->excludes(paper);
  add_method_option(*command, o->method);
  auto* picture =
      command->add_option("--picture", o->truth.picture, "file to write: PNG or SVG of the map with truth and robot")
          ->check(file_name());
  paper->excludes(command->get_option("--method"))->excludes(picture);
  command->add_flag("--json", o->json, "figures as JSON instead of a table");
  command->callback([o, command] {
    if (command->count("--method") > 0) o->truth.method = o->method;
    if (o->truth.dir.empty() && o->paper.empty())
      throw CLI::RequiredError(command->get_name() + ": DIR or --paper DATA");
    const nlohmann::json figures =
        o->paper.empty() ? evaluate_truth(o->truth, !o->json) : evaluate_paper(o->paper, !o->json);
    if (o->json) std::cout << figures.dump(2) << '\n';
  });
}

}  // namespace curbline::tools
