#include "program.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <random>

extern char** environ;

namespace curbline::tools::testing {
namespace {

pid_t start(const char* program, const Words& arguments, const std::string& out_file, const std::string& err_file) {
  Words words{program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  pid_t child = 0;
  const int failed = ::posix_spawn(&child, program, &files, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (failed != 0) throw std::runtime_error(std::string("the program cannot be started: ") + program);
  return child;
}

}  // namespace

Words operator+(Words arguments, const Words& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

Outcome run(const char* program, const Words& arguments, const std::string& out_file) {
  const TemporaryDirectory outputs;
  const std::string out = out_file.empty() ? outputs.path("out") : out_file;
  const auto began = std::chrono::steady_clock::now();
  const pid_t child = start(program, arguments, out, outputs.path("err"));
  int status = 0;
  rusage used{};
  if (::wait4(child, &status, 0, &used) != child) throw std::runtime_error("the program cannot be waited for");
  Outcome outcome;
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  outcome.peak_kib = used.ru_maxrss;
  if (out_file.empty()) outcome.out = read_file(out);
  outcome.err = read_file(outputs.path("err"));
  return outcome;
}

Outcome curbline(const Words& arguments, const std::string& out_file) {
  return run(CURBLINE_PROGRAM, arguments, out_file);
}

std::string line_of(const Words& arguments) {
  std::string line = "'" CURBLINE_PROGRAM "'";
  for (const std::string& word : arguments) line += " '" + word + "'";
  return line;
}

Words lines_of(const std::string& text) {
  Words lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

std::string shipped_robot(const std::string& name) {
  return CURBLINE_SOURCE_DIR "/tools/robots/" + name + ".toml";
}

Words names_in(const std::string& directory) {
  Words names;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

void check_refused(const Outcome& outcome, const std::string& start, const std::string& part) {
  INFO("standard error: " << outcome.err);
  CHECK(outcome.status == 1);
  CHECK(outcome.out.empty());
  CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  CHECK(outcome.err.ends_with('\n'));
  CHECK(outcome.err.find("expected") != std::string::npos);
  CHECK(outcome.err.starts_with(start));
  CHECK(outcome.err.find(part) != std::string::npos);
}

void check_wrong_usage(const Outcome& outcome, const std::string& part) {
  INFO("standard error: " << outcome.err);
  CHECK(outcome.status == 2);
  CHECK(outcome.out.empty());
  CHECK(outcome.err.find(part) != std::string::npos);
}

Recording::Recording(const std::string& scene, const std::string& robot, const Words& more) {
  const Words simulate{"simulate", "--scene", scene, "--robot", robot.ends_with(".toml") ? robot : shipped_robot(robot),
                       "--out",    path("")};
  const Outcome outcome = curbline(simulate + more);
  INFO("standard error: " << outcome.err);
  REQUIRE(outcome.status == 0);
  REQUIRE(outcome.err.empty());  // progress is shown on terminals only
}

Words Recording::replay(const std::string& replaced, const std::string& by) const {
  Words arguments{"replay"};
  const auto add = [&](const std::string& what, const std::string& name) {
    const std::string file = what == replaced ? by : path(name);
    if (std::filesystem::exists(path(name)) && !file.empty()) arguments.insert(arguments.end(), {"--" + what, file});
  };
  add("scans", "scans.carmen");
  add("can", "can.log");
  add("poses", "poses.tum");
  add("robot", "robot.toml");
  return arguments;
}

std::string with_line(const std::string& text, std::size_t number, const std::string& line) {
  Words lines = lines_of(text);
  lines.at(number - 1) = line;
  std::string out;
  for (const std::string& each : lines) out += each + "\n";
  return out;
}

std::string long_line(const TemporaryDirectory& directory, const std::string& name, const std::string& start) {
  const std::string path = directory.write(name, start);
  std::filesystem::resize_file(path, 100'000'000);
  return path;
}

std::string cloud_with_a_step(const TemporaryDirectory& directory) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise_m(0.0, 0.005);
  std::string text;
  for (int i = 0; i < 160; ++i) {
    for (int j = 0; j < 160; ++j) {
      const double x = (i + 0.5) * 0.025, y = (j + 0.5) * 0.025 - 2.0;
      text += std::to_string(x) + " " + std::to_string(y) + " " +
              std::to_string((x < 2.0 ? 0.0 : 0.12) + noise_m(random)) + "\n";
    }
  }
  return directory.write("step.xyz", text);
}

}  // namespace curbline::tools::testing
