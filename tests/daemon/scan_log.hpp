// A log of scan lines for the daemon's tests.
#pragma once

#include <cstdint>
#include <string>

#include "formats/decimals.hpp"
#include "tools/formats_support.hpp"

namespace curbline::daemon {

/// Writes `lines` lines of a UTM-30LX, 40 a second, that see a wall 1.5 m away. Returns its path.
inline std::string write_scan_log(const tools::testing::TemporaryDirectory& directory, int lines) {
  std::string ranges = "RAWLASER1 0 -2.3561945 4.712389 0.004363323 60.000 0.030 0 1081", log;
  for (int i = 0; i < 1081; ++i) ranges += " 1.500";
  for (std::int64_t i = 0; i < lines; ++i) {
    const std::string time = tools::seconds(1'700'000'000'000'000'000 + i * 25'000'000, 6);
    log += ranges + " 0 " + time + " host " + time + "\n";
  }
  return directory.write("scans.carmen", log);
}

}  // namespace curbline::daemon
