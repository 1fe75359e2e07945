// Converts logs to the stream that boards are fed, and the stream of results to curbs.
#pragma once

#include <string>
#include <vector>

#include "map/map.hpp"
#include "streams/log_remarks.hpp"

namespace curbline::tools {

struct DriveFiles {
  std::string robot;  ///< TOML
  DriveLogs logs;     ///< recorded ones
  std::string out;
};

/// CAN frames up to the first reading that covers a line's last beam, poses up to it, then the line: as `curbline
/// replay` feeds the pipeline, with some more readings ahead. Returns remarks for the user: those of `curbline replay`
/// that are about the logs themselves. Throws BadInput.
std::string write_drive(const DriveFiles& files);

/// The curbs after the last scan line of a stream of results. Throws BadInput.
std::vector<MapCurb> read_last_curbs(const std::string& path);

}  // namespace curbline::tools
