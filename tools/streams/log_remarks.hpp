// What is told of a drive's logs at the end, one line each, by those who read them: `curbline replay`, and
// `curbline-drive-log write` for a board.
#pragma once

#include <string>

#include "curbline/intake/nod_watch.hpp"
#include "formats/can_log.hpp"
#include "robot/robot.hpp"
#include "streams/radians_watch.hpp"

namespace curbline::tools {

/// The logs of one drive. `can` may be a live interface, "can:vcan0", and `scans` a live scanner (scanner_link.hpp), of
/// a replay; `can` and `poses` are empty if the robot has none.
struct DriveLogs {
  std::string scans, can, poses;
};

class Remarks {
 public:
  /// Lines as they are; none if empty.
  void add(const std::string& lines);
  /// "LOG: WHAT"
  void say(const std::string& log, const std::string& what);
  /// "LOG: COUNT of WHAT", unless the count is 0.
  void say_of(const std::string& log, long count, const std::string& what);

  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// What the tilt's readings tell of the servo, by the daemon's watches: angles that are no radians, a tilt that rests.
class TiltRemarks {
 public:
  explicit TiltRemarks(const Robot& robot);
  /// Call with each reading that the pipeline takes.
  void update(const TiltReading& reading);
  /// `readings`: how many there were.
  void say(Remarks& remarks, const std::string& can, long readings) const;

 private:
  float sweep_s_;  ///< there and back
  RadiansWatch radians_;
  NodWatch nod_;
};

void say_lost_frames(Remarks& remarks, const CanLogReader& can);
/// Logs that were given or lie beside, and were not read.
void say_unread(Remarks& remarks, const Robot& robot, const DriveLogs& logs);

}  // namespace curbline::tools
