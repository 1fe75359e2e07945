// The three scanners, small ones, with a session and a simulated device each, joined in memory.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scanner/device.hpp"
#include "scanner/server.hpp"
#include "scanner/session.hpp"

namespace curbline::test {

using tools::Bytes, tools::CarmenLine;

struct Scanner {
  std::string name;
  tools::Protocol protocol;
  CarmenLine first;  ///< a line of its geometry
  std::shared_ptr<scanner::Session> session;
  std::unique_ptr<tools::Device> device;
};

/// UTM-30LX of 41 beams, LMS1xx of 21, LMS200 of 101: telegrams of 100 to 200 bytes.
std::vector<Scanner> small_scanners();

/// Those of the robots that ship: 1081, 541 and 181 beams.
std::vector<Scanner> whole_scanners();

/// Line `index`: each beam of each has a range of its own, to the millimetre, one in eleven none.
CarmenLine line_of(const CarmenLine& geometry, int index);

/// Sets the scanner up to measure: commands and replies go to and fro until there is nothing to say.
void start(Scanner& scanner);

/// The telegrams of lines from `first` on.
std::vector<Bytes> telegrams_of(Scanner& scanner, int count, int first = 0);

Bytes joined(const std::vector<Bytes>& telegrams);

/// The lines that a session reads from bytes, as indices of line_of(); -1 for one that is none of the first 1000.
std::vector<int> lines_read(Scanner& scanner, const Bytes& bytes);

/// Index of a line, by its ranges.
int index_of(const CarmenLine& geometry, std::span<const float> ranges_m);

/// What was dropped, of any kind.
std::uint64_t dropped(const scanner::Counters& counters);

/// A log of `count` lines in a scan feed's form.
std::string carmen_text(const CarmenLine& geometry, int count);

Bytes from_hex(const std::string& text);

}  // namespace curbline::test
