// Which words the daemon has for which counter; tests/can has those of the bus.
#include "troubles.hpp"

#include "error_pipe.hpp"

namespace curbline::daemon {
namespace {

TEST_CASE("troubles: each counter is told in its own words, with its count") {
  can::TiltDecoderCounters frames;
  ScannerState scanner;
  Report report;
  report.tilt_frames = &frames;
  report.scanner = &scanner;
  Troubles troubles;
  const auto says = [&](auto& counter, const std::string& words) {
    counter = 3;
    ErrorPipe standard_error;
    troubles.tell(report, {}, 0);
    CHECK(standard_error.read() == "curblined: " + words + " (3 so far)\n");
    troubles.tell(report, {}, 0);
    CHECK(standard_error.read().empty());
    counter = 0;
    troubles = {};
  };
  says(frames.malformed, "damaged tilt frames");
  says(frames.without_sync, "tilt frames whose SYNC was not seen");
  says(report.pipeline.tilt_dropped, "tilt readings that are not later than the one before, dropped");
  says(report.poses.damaged, "lines that are no poses, passed over");
  says(report.pipeline.poses_dropped, "poses that are impossible or not later than the one before, dropped");
  says(report.angles_beyond,
       "tilt angles more than a turn from where the sweep began; expected radians, see scale of tilt.signal");
  says(report.not_recorded, "tilt frames that the recording does not have");
  says(report.lines.dropped, "scan lines came faster than they are taken");
  says(report.lines.crowded, "scan lines came faster than they are taken");
  says(report.lines.bad_time, "scan lines with a damaged stamp, dropped");
  says(report.lines_without_tilt, "scan lines with no tilt angle at their time, dropped; see max_gap_s");
  says(report.lines_without_pose, "scan lines with no pose at their time, dropped");
  says(scanner.other_beams, "scan lines whose beams are not those of the robot's laser, dropped");
  says(report.lines.too_long, "scan lines whose beams are not those of the robot's laser, dropped");
  says(scanner.damaged, "damaged telegrams of the scanner");
  says(scanner.device_errors, "faults, or a dirty front screen, that the scanner reports");
  says(report.server.too_slow, "a client was too slow, and dropped");
  says(report.server.refused, "more clients than there is room for");
}

}  // namespace
}  // namespace curbline::daemon
