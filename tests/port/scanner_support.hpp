// Small versions of the three scanners, each with a session and a simulated device, connected in memory.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scanner/session.hpp"
#include "scanner_simulator/device.hpp"
#include "scanner_simulator/server.hpp"

namespace curbline::test {

using tools::Bytes, tools::CarmenLine;

struct Scanner {
  std::string name;
  tools::Protocol protocol;
  CarmenLine first;  ///< a line with its geometry
  std::shared_ptr<scanner::Session> session;
  std::unique_ptr<tools::Device> device;
};

/// UTM-30LX with 41 beams, LMS1xx with 21, LMS200 with 101: telegrams of 100 to 200 bytes.
std::vector<Scanner> small_scanners();

/// The scanners of the shipped robots: 1081, 541 and 181 beams.
std::vector<Scanner> whole_scanners();

/// Line `index`: each beam of each line has its own range, to the millimetre; one in eleven has no return.
CarmenLine line_of(const CarmenLine& geometry, int index);

/// Sets the scanner up to measure: exchanges commands and replies until the session has nothing to send.
void start(Scanner& scanner);

/// The telegrams of `count` lines from `first` on.
std::vector<Bytes> telegrams_of(Scanner& scanner, int count, int first = 0);

Bytes joined(const std::vector<Bytes>& telegrams);

/// The lines that a session reads from bytes, as indices of line_of(); -1 for a line that is not among the first 1000.
std::vector<int> lines_read(Scanner& scanner, const Bytes& bytes);

/// Index of a line, found by its ranges.
int index_of(const CarmenLine& geometry, std::span<const float> ranges_m);

/// Sum of everything dropped, of any kind.
std::uint64_t dropped(const scanner::Counters& counters);

/// A log of `count` lines, in the format of a scan feed.
std::string carmen_text(const CarmenLine& geometry, int count);

Bytes from_hex(const std::string& text);

}  // namespace curbline::test
