// Starts the program and inspects its exit status, output and files.
#pragma once

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "map/map.hpp"
#include "tools/formats_support.hpp"

namespace curbline::tools::testing {

using Words = std::vector<std::string>;

/// Appends arguments.
Words operator+(Words arguments, const Words& more);

/// Result of a run of the program. `status` is the exit status, or minus the number of the signal that ended it.
struct Outcome {
  int status = 0;
  std::string out, err;
  double seconds = 0;
  long peak_kib = 0;  ///< peak memory
};

/// Runs curbline, or another program, to its end. Its standard output goes to out_file if one is given.
Outcome curbline(const Words& arguments, const std::string& out_file = {});
Outcome run(const char* program, const Words& arguments, const std::string& out_file = {});

/// A command line for the shell that runs curbline.
std::string line_of(const Words& arguments);

Words lines_of(const std::string& text);

/// The description of a shipped robot.
std::string shipped_robot(const std::string& name);

/// Sorted names of all entries of a directory.
Words names_in(const std::string& directory);

/// CHECKs exit status 1, nothing on standard output, and one line on standard error that begins with `start`, contains
/// `part` and says what was expected.
void check_refused(const Outcome& outcome, const std::string& start, const std::string& part);

/// CHECKs exit status 2, nothing on standard output, and `part` on standard error.
void check_wrong_usage(const Outcome& outcome, const std::string& part);

/// Logs of a simulated scene, in a directory that is removed at the end.
class Recording {
 public:
  /// robot: the name of a shipped robot, or a file (.toml).
  Recording(const std::string& scene, const std::string& robot, const Words& more = {});

  std::string path(const std::string& name) const { return directory_.path(name); }
  std::string folder() const { return std::filesystem::path(path("")).parent_path(); }
  const TemporaryDirectory& directory() const { return directory_; }

  /// Arguments of replay with these logs. The log named `replaced` ("scans", "can", "poses" or "robot") is replaced by
  /// the file `by`.
  Words replay(const std::string& replaced = {}, const std::string& by = {}) const;

 private:
  TemporaryDirectory directory_;
};

/// Text with line `number`, from 1, replaced.
std::string with_line(const std::string& text, std::size_t number, const std::string& line);

/// A file of 100 MB: `start`, then no line end. It occupies little disk space.
std::string long_line(const TemporaryDirectory& directory, const std::string& name, const std::string& start);

/// A cloud, and its file: two level planes that meet at x = 2.0 with a step of 0.12 m, x in [0, 4], y in [-2, 2].
std::string cloud_with_a_step(const TemporaryDirectory& directory);

}  // namespace curbline::tools::testing
