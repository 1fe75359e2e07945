#include "streams/log_remarks.hpp"

#include <algorithm>
#include <filesystem>

#include "formats/decimals.hpp"
#include "formats/file_exists.hpp"
#include "streams/scanner_link.hpp"

namespace curbline::tools {

void Remarks::add(const std::string& lines) {
  if (!lines.empty()) text_ += (text_.empty() ? "" : "\n") + lines;
}

void Remarks::say(const std::string& log, const std::string& what) {
  add(log + ": " + what);
}

void Remarks::say_of(const std::string& log, long count, const std::string& what) {
  if (count > 0) say(log, std::to_string(count) + " of " + what);
}

TiltRemarks::TiltRemarks(const Robot& robot) : sweep_s_(std::max(static_cast<float>(robot.sweep.period_s), 0.5f)) {
  radians_.init(sweep_s_);
  nod_.init(sweep_s_, robot.tilt.fixed);
}

void TiltRemarks::update(const TiltReading& reading) {
  radians_.update(reading);
  nod_.update(reading);
}

void TiltRemarks::say(Remarks& remarks, const std::string& can, long readings) const {
  const auto beyond = static_cast<long>(radians_.beyond());
  if (radians_.in_doubt() || 2 * beyond > readings) {
    remarks.say_of(can, beyond,
                   std::to_string(readings) +
                       " tilt angles are more than a turn from where their sweep began; expected radians, see scale of "
                       "tilt.signal");
  }
  if (nod_.watch().times_lost() > 0) {
    remarks.say(can, "the tilt rests for more than " + shortest(sweep_s_) +
                         " s, a sweep there and back; expected a servo that nods, and an encoder that is not stuck");
  }
}

void say_lost_frames(Remarks& remarks, const CanLogReader& can) {
  if (can.frames_lost() > 0) remarks.say(can.path(), std::to_string(can.frames_lost()) + " frames lost by candump");
}

void say_unread(Remarks& remarks, const Robot& robot, const DriveLogs& logs) {
  if (robot.tilt.fixed && !logs.can.empty()) remarks.say(logs.can, "not read; the tilt is fixed");
  const std::filesystem::path poses = std::filesystem::path(logs.scans).replace_filename("poses.tum");
  if (logs.poses.empty() && !is_scanner(logs.scans) && file_exists(poses))
    remarks.say(poses.string(), "not read, the robot was taken to stand; expected --poses");
}

}  // namespace curbline::tools
