// The firmware of a board that reads its logs from the host: runs a drive through the pipeline and writes the results
// back. Its command line comes from the emulator's -semihosting-config: PROGRAM DRIVE RESULTS.
#include <cstdint>

#include "drive.hpp"
#include "runtime.hpp"
#include "semihosting/semihosting.hpp"

namespace semihosting = curbline::semihosting;

namespace {

curbline::Pipeline<curbline::board::limits> pipeline;
semihosting::FilePair files;
curbline::board::Drive drive(files, pipeline);

}  // namespace

int main() {
  const semihosting::CommandLine command_line;
  const auto words = command_line.words();
  if (words.size() != 3) {
    semihosting::print("usage: FIRMWARE DRIVE RESULTS\n");
    return 2;
  }
  if (!files.open(words[1], words[2])) {
    semihosting::print("a file cannot be opened; expected DRIVE to read and RESULTS to write\n");
    return 1;
  }
  const curbline::board::DriveEnd end = drive.run();
  semihosting::print_number("stack bytes used: ", static_cast<std::uint32_t>(curbline::board::stack_used()));
  if (end == curbline::board::DriveEnd::done) return 0;
  semihosting::print(to_string(end));
  semihosting::print("\n");
  return 1;
}
