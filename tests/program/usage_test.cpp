// Wrong usage: exit status 2.
#include "program.hpp"
#include "simulator/scene.hpp"

namespace curbline::tools::testing {
namespace {

TEST_CASE("program: --help and the help of each command exit with 0") {
  const Outcome help = curbline({"--help"});
  CHECK(help.status == 0);
  CHECK(help.err.empty());
  for (const std::string command : {"simulate", "replay", "map", "evaluate", "dbc"}) {
    CHECK(help.out.find(command) != std::string::npos);
    const Outcome of_command = curbline({command, "--help"});
    CHECK(of_command.status == 0);
    CHECK(of_command.out.find("--") != std::string::npos);
  }
}

TEST_CASE("program: the help of every program says what each option is, and what its exit statuses are") {
  const auto check = [](const char* program, const Words& command) {
    const std::string help = run(program, command + Words{"--help"}).out;
    INFO(help);
    // The line of an option without a description ends in blanks.
    for (const std::string& line : lines_of(help)) CHECK_FALSE(line.ends_with(' '));
    if (command.empty()) CHECK(help.find("Exit status: 0 done; 1 the input is bad") != std::string::npos);
  };
  for (const char* program : {CURBLINE_PROGRAM, CURBLINED, CURBLINE_SCANNER, CURBLINE_DRIVE_LOG}) check(program, {});
  for (const char* command : {"simulate", "replay", "map", "evaluate", "dbc"}) check(CURBLINE_PROGRAM, {command});
  for (const char* command : {"write", "curbs"}) check(CURBLINE_DRIVE_LOG, {command});
}

TEST_CASE("program: the help of simulate names the scenes that ship") {
  const std::string help = curbline({"simulate", "--help"}).out;
  for (const std::string& name : shipped_scenes()) CHECK(help.find(" " + name) != std::string::npos);
}

TEST_CASE("program: --version of every program tells its name and the version of them all") {
  const std::string version = curbline({"--version"}).out.substr(std::string("curbline ").size());
  CHECK(version.find_first_not_of("0123456789.\n") == std::string::npos);
  const auto check = [&](const std::string& name, const Outcome& outcome) {
    CHECK(outcome.status == 0);
    CHECK(outcome.out == name + " " + version);
    CHECK(outcome.err.empty());
  };
  check("curbline", curbline({"--version"}));
  check("curblined", run(CURBLINED, {"--version"}));
  check("curbline-scanner", run(CURBLINE_SCANNER, {"--version"}));
  check("curbline-drive-log", run(CURBLINE_DRIVE_LOG, {"--version"}));
}

TEST_CASE("program: no command, an unknown command and an unknown option are wrong usage") {
  check_wrong_usage(curbline({}), "required");
  check_wrong_usage(curbline({"mop"}), "mop is no command; expected one of simulate");
  check_wrong_usage(curbline({"--foo"}), "required");
  check_wrong_usage(curbline({"map", "a.xyz", "--foo"}), "--foo");
}

TEST_CASE("program: what a command needs and a value that is missing are named") {
  check_wrong_usage(curbline({"map"}), "cloud");
  check_wrong_usage(curbline({"evaluate"}), "DIR");
  check_wrong_usage(curbline({"replay", "--scans", "s"}), "--robot");
  check_wrong_usage(curbline({"replay", "--robot", "r"}), "--scans");
  check_wrong_usage(curbline({"simulate", "--scene", "street", "--robot", "r"}), "--out");
  check_wrong_usage(curbline({"map", "a.xyz", "--labels"}), "--labels");
  check_wrong_usage(curbline({"evaluate", "dir", "--paper", "data"}), "--paper");
}

TEST_CASE("program: a window has an origin and a size") {
  check_wrong_usage(curbline({"map", "a.xyz", "--origin", "0", "0"}), "--size");
  check_wrong_usage(curbline({"map", "a.xyz", "--size", "4", "4"}), "--origin");
  check_wrong_usage(curbline({"map", "a.xyz", "--origin", "0", "--size", "4", "4"}), "--origin");
}

TEST_CASE("program: an origin that lies farther off than a robot's window may is wrong usage of replay") {
  const Recording logs("street", "utm30lx", {"--duration", "0.1"});
  for (const Words& place : {Words{"200000", "0"}, {"0", "-1e9"}})
    check_wrong_usage(curbline(logs.replay() + Words{"--origin"} + place + Words{"--size", "4", "4"}),
                      "; expected metres in [-1e5, 1e5], of a robot's window\n");
}

TEST_CASE("program: no output takes the place of an input or of another output") {
  const TemporaryDirectory dir;
  const std::string cloud = dir.write("a.xyz", "1 1 0\n"), new_file = dir.path("new.csv");
  std::filesystem::create_symlink(cloud, dir.path("link.xyz"));
  const Words names = names_in(dir.path(""));
  const auto refused = [&](const Words& arguments, const std::string& part) {
    check_wrong_usage(curbline(arguments), part);
    CHECK(names_in(dir.path("")) == names);
    CHECK(read_file(cloud) == "1 1 0\n");
  };
  for (const std::string& name : {cloud, dir.path("./a.xyz"), dir.path("link.xyz")}) {
    for (const std::string option : {"--labels", "--curbs", "--picture"})
      refused({"map", cloud, option, name}, option + ": " + name + " is also the cloud; expected another file");
  }
  refused({"map", cloud, "--labels", new_file, "--curbs", dir.path("./new.csv")}, "is also --labels");
  CHECK(curbline({"map", cloud, "--labels", "/dev/null", "--curbs", "/dev/null"}).status == 0);

  for (const std::string input : {"--scans", "--can", "--poses", "--robot"}) {
    for (const std::string output : {"--labels", "--curbs", "--picture", "--line-costs"}) {
      Words arguments{"replay", output, cloud};
      for (const std::string option : {"--scans", "--can", "--poses", "--robot"})
        arguments = arguments + Words{option, option == input ? cloud : dir.path("none")};
      refused(arguments, "is also " + input);
    }
  }
}

TEST_CASE("program: standard output is for curbs alone") {
  const TemporaryDirectory dir;
  const std::string cloud = dir.write("a.xyz", "1 1 0\n");
  for (const std::string option : {"--labels", "--picture"})
    check_wrong_usage(curbline({"map", cloud, option, "-"}), option + ": -; expected a file name");
  check_wrong_usage(curbline({"replay", "--scans", cloud, "--robot", cloud, "--line-costs", "-"}), "--line-costs: -;");
}

TEST_CASE("program: an unknown method or edge and the values that there are") {
  for (const std::string word : {"foo", "4"}) {
    check_wrong_usage(curbline({"map", "a.xyz", "--method", word}),
                      "--method: " + word + "; expected one of curbline, crf-em, em, segment, canny, gradient\n");
    check_wrong_usage(curbline({"map", "a.xyz", "--edge", word}),
                      "--edge: " + word + "; expected one of potts, eq10\n");
  }
}

TEST_CASE("program: options that only other methods use are refused") {
  for (const Words& method : {Words{}, {"--method", "curbline"}, {"--method", "canny"}, {"--method", "gradient"}}) {
    check_wrong_usage(curbline(Words{"map", "a.xyz", "--edge", "eq10"} + method),
                      "--edge: of another method; expected --method crf-em, em or segment\n");
    check_wrong_usage(curbline(Words{"map", "a.xyz", "--segment-scale", "50"} + method),
                      "--segment-scale: of another method; expected --method crf-em, em or segment\n");
  }
  check_wrong_usage(curbline({"replay", "--scans", "s", "--robot", "r", "--edge", "eq10"}),
                    "--edge: of another method");
}

TEST_CASE("program: an empty file name, as an unset variable of a shell gives, is wrong usage") {
  const auto refused = [](const Words& arguments, const std::string& option) {
    check_wrong_usage(curbline(arguments + Words{option, ""}), option + ": empty; expected a file name\n");
  };
  for (const std::string option : {"--labels", "--curbs", "--picture"}) {
    refused({"map", "a.xyz"}, option);
    refused({"replay", "--scans", "s", "--robot", "r"}, option);
  }
  for (const std::string option : {"--can", "--poses", "--line-costs"})
    refused({"replay", "--scans", "s", "--robot", "r"}, option);
  refused({"simulate", "--scene", "street", "--robot", "r"}, "--out");
  refused({"evaluate", "d"}, "--picture");
  refused({"evaluate"}, "--paper");
  refused({"dbc"}, "--robot");
  check_wrong_usage(curbline({"map", ""}), "empty; expected a file name");
  check_wrong_usage(curbline({"simulate", "--scene", "", "--robot", "r", "--out", "o"}),
                    "--scene: empty; expected a scene\n");
  const Words scanner{"scip2", "--robot", "r"};
  check_wrong_usage(run(CURBLINE_SCANNER, scanner + Words{"--scene", ""}), "--scene: empty; expected a scene\n");
  check_wrong_usage(run(CURBLINE_SCANNER, scanner + Words{"--scans", ""}), "--scans: empty; expected a file name\n");
  check_wrong_usage(run(CURBLINE_SCANNER, {"scip2", "--scene", "street", "--robot", ""}),
                    "--robot: empty; expected a file name\n");
}

TEST_CASE("program: a seed that is no whole number of 64 bits is wrong usage") {
  const TemporaryDirectory dir;
  for (const std::string bad : {"-1", "18446744073709551616", "1.5", "x"}) {
    check_wrong_usage(curbline({"simulate", "--scene", "street", "--robot", shipped_robot("utm30lx"), "--out",
                                dir.path("o"), "--seed", bad}),
                      "--seed: " + bad + "; expected a whole number from 0 to 18446744073709551615\n");
  }
  CHECK(names_in(dir.path("")).empty());
}

TEST_CASE("program: an option that is given twice is wrong usage") {
  check_wrong_usage(curbline({"map", "a.xyz", "--cell", "0.1", "--cell", "0.2"}),
                    "--cell: given twice, or empty; expected once\n");
  for (const Words& twice : {Words{"--cell", "0.1", "0.2", "--cell", "0.2"},
                             {"--labels", "a", "--labels", "b"},
                             {"--max-height", "1", "--max-height", "2"}})
    check_wrong_usage(curbline(Words{"map", "a.xyz"} + twice), twice.front());
}

TEST_CASE(
    "program: a cloud after a window's numbers is accepted, where it is ambiguous the user is told where to put it") {
  const TemporaryDirectory dir;
  const std::string cloud = dir.write("a.xyz", "1 1 0\n");
  for (const Words& window : {Words{"--origin", "0", "0", "--size", "4", "4"},
                              {"--size", "4", "4", "--origin", "0", "0"},
                              {"--cell", "0.1", "0.2"}})
    CHECK(curbline(Words{"map"} + window + Words{cloud, "--json"}).status == 0);
  CHECK(curbline({"map", "--json", "--cell", "0.1", cloud}).status == 0);
  check_wrong_usage(curbline({"map", "--cell", "0.1", cloud, "--json"}),
                    "--cell: " + cloud + "; expected metres in [0.001, 10]; a cloud comes before --cell, or last\n");
  check_wrong_usage(curbline({"map", "--origin", "0", "1.xyz", "--size", "4", "4"}), "--origin: 1.xyz; expected");
}

TEST_CASE("program: a number that makes no sense is wrong usage and named") {
  const TemporaryDirectory dir;
  const std::string cloud = dir.write("a.xyz", "1 1 0\n");
  const auto map = [&](const Words& more) { return curbline(Words{"map", cloud} + more); };
  for (const std::string bad : {"0", "-1", "nan", "inf", "1e9", "x"}) {
    INFO(bad);
    check_wrong_usage(map({"--cell", bad}), "--cell");
  }
  for (const std::string bad : {"0", "-4", "nan", "inf"})
    check_wrong_usage(map({"--segment-scale", bad}),
                      "--segment-scale: " + bad + "; expected a finite number above 0\n");
  check_wrong_usage(map({"--segment-scale", "x"}), "--segment-scale");
  check_wrong_usage(map({"--max-height", "1e300"}), "--max-height: 1e300; expected metres in [-1e9, 1e9]\n");
  for (const std::string bad : {"nan", "inf", "x", "1e39"}) {
    check_wrong_usage(map({"--max-height", bad}), "--max-height");
    check_wrong_usage(map({"--origin", bad, "0", "--size", "4", "4"}), "--origin");
  }
  for (const std::string bad : {"0", "-4", "nan", "inf", "x", "1e-9"}) {
    check_wrong_usage(map({"--origin", "0", "0", "--size", bad, "4"}), "--size");
  }
}

TEST_CASE("program: an empty text, as a shell's unset variable gives, is no number") {
  const TemporaryDirectory dir;
  const std::string cloud = dir.write("a.xyz", "1 1 0\n");
  check_wrong_usage(curbline({"map", cloud, "--origin", "", "-2", "--size", "4", "4"}),
                    "--origin: empty; expected metres in [-1e9, 1e9]\n");
  check_wrong_usage(curbline({"map", cloud, "--max-height", ""}),
                    "--max-height: empty; expected metres in [-1e9, 1e9]\n");
  check_wrong_usage(curbline({"replay", "--scans", cloud, "--robot", shipped_robot("utm30lx"), "--speed", ""}),
                    "--speed: empty; expected max or a number from 0.001 to 1000\n");
  const Words simulate{"simulate", "--scene", "street", "--robot", shipped_robot("utm30lx"), "--out", dir.path("o")};
  check_wrong_usage(curbline(simulate + Words{"--seed", ""}),
                    "--seed: empty; expected a whole number from 0 to 18446744073709551615\n");
  check_wrong_usage(curbline(simulate + Words{"--duration", ""}),
                    "--duration: empty; expected seconds above 0, at most a day\n");
}

TEST_CASE("program: a window of more than 512 cells is refused") {
  const TemporaryDirectory dir;
  const std::string cloud = dir.write("a.xyz", "1 1 0\n");
  check_wrong_usage(curbline({"map", cloud, "--origin", "0", "0", "--size", "4", "51.4"}), "512");
  check_wrong_usage(curbline({"map", cloud, "--origin", "0", "0", "--size", "4", "4", "--cell", "0.001"}), "512");
  for (const std::string size : {"51.21", "51.24", "51.2001"}) {
    check_wrong_usage(curbline({"map", cloud, "--origin", "0", "0", "--size", size, "4"}), "512");
  }
  CHECK(curbline({"map", cloud, "--origin", "0", "0", "--size", "4", "51.2"}).status == 0);
  // As a float, 0.7 is below 0.7, so 512 cells of it would be less than 358.4 m.
  CHECK(curbline({"map", cloud, "--origin", "0", "0", "--size", "4", "358.4", "--cell", "0.7"}).status == 0);
}

TEST_CASE("program: a speed and a duration that make no sense are wrong usage") {
  const Recording logs("street", "utm30lx", {"--duration", "0.1"});
  for (const std::string bad : {"fast", "0", "-1", "nan", "1x", "inf", "1e-300", "0.0009", "1001"}) {
    check_wrong_usage(curbline(logs.replay() + Words{"--speed", bad}),
                      "--speed: " + bad + "; expected max or a number from 0.001 to 1000\n");
  }
  for (const std::string bad : {"0", "-1", "nan", "inf", "x", "1e300", "5s"}) {
    const TemporaryDirectory out;
    check_wrong_usage(curbline({"simulate", "--scene", "street", "--robot", shipped_robot("utm30lx"), "--out",
                                out.path("o"), "--duration", bad}),
                      "--duration: " + bad + "; expected seconds above 0, at most a day\n");
    CHECK(names_in(out.path("")).empty());
  }
}

}  // namespace
}  // namespace curbline::tools::testing
