// Logs to the stream that boards are fed, and the stream of results to curbs.
#pragma once

#include <string>
#include <vector>

#include "map/map.hpp"

namespace curbline::tools {

struct DriveFiles {
  std::string robot;              ///< TOML
  std::string scans, can, poses;  ///< can and poses are empty where the robot has none
  std::string out;
};

/// CAN frames up to the first reading that covers a line's last beam, poses up to it, then the line: what `curbline
/// replay` gives the pipeline, with some readings more of the time to come. Returns what a user should know of the
/// lines' stamps (LaserLog::remarks()). Throws BadInput.
std::string write_drive(const DriveFiles& files);

/// The curbs after the last scan line of a stream of results. Throws BadInput.
std::vector<MapCurb> read_last_curbs(const std::string& path);

}  // namespace curbline::tools
