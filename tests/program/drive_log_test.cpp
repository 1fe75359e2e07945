// curbline-drive-log: logs to what boards are fed, and what they give back to curbs.
#include "program.hpp"

namespace curbline::tools::testing {
namespace {

Outcome drive_log(const Words& arguments, const std::string& out_file = {}) {
  return run(CURBLINE_DRIVE_LOG, arguments, out_file);
}

/// The logs of a recording, without --out.
Words write_of(const Recording& logs) {
  Words arguments = logs.replay();
  arguments.front() = "write";
  return arguments;
}

TEST_CASE("drive log: the stream takes the place of no log that it is made of") {
  const Recording logs("street", "utm30lx", {"--duration", "0.1"});
  const Words names = names_in(logs.folder());
  for (const auto& [option, name] :
       {std::pair{"--scans", "scans.carmen"}, {"--can", "can.log"}, {"--robot", "robot.toml"}}) {
    const std::string input = logs.path(name), before = read_file(input);
    check_wrong_usage(drive_log(write_of(logs) + Words{"--out", input}),
                      "--out: " + input + " is also " + option + "; expected another file");
    CHECK(read_file(input) == before);
  }
  const Recording drive("city", "utm30lx", {"--duration", "0.1"});
  check_wrong_usage(drive_log(write_of(drive) + Words{"--out", drive.path("poses.tum")}), "is also --poses");
  CHECK(names_in(logs.folder()) == names);
  CHECK(drive_log(write_of(logs) + Words{"--out", logs.path("drive")}).status == 0);
}

}  // namespace
}  // namespace curbline::tools::testing
