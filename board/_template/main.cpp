// The firmware of a robot: tilt frames and scan lines in, the curb ahead out, as CAN frames. Copy this folder; port.hpp
// contains what depends on the board, robot.hpp what depends on the robot.
#include <algorithm>
#include <array>

#include "curbline/assertion.hpp"
#include "curbline/can/curb_frames.hpp"
#include "curbline/can/tilt_decoder.hpp"
#include "curbline/intake/line_queue.hpp"
#include "curbline/intake/nod_watch.hpp"
#include "curbline/intake/sight_watch.hpp"
#include "curbline/intake/source_watch.hpp"
#include "curbline/pipeline.hpp"
#include "port.hpp"
#include "robot.hpp"
#include "runtime.hpp"

namespace can = curbline::can;

namespace {

// All memory that the firmware uses.
Port port;
curbline::Pipeline<limits> pipeline;
curbline::LineQueue<limits, queued_lines> waiting;  // lines whose last beams have no tilt or pose yet
can::TiltDecoder decoder;
curbline::SourceWatch watch;  // on the servo
curbline::NodWatch nod;       // on whether the tilt moves
curbline::SightWatch sight;   // of the laser
curbline::NewestTimes newest;
curbline::Pose pose;            // the newest; for a stationary robot, the map's origin
std::uint8_t curbs_told = 255;  // so that the first CurbAhead has 0

void start() {
  const curbline::Settings settings = robot_settings();
  if (pipeline.init(settings) != curbline::Status::ok) port.stop(curbline::bad_setting(settings, limits));
  if (!decoder.init(tilt_signal())) port.stop("the tilt signal is not valid");
  if (!settings.tilt.fixed && can::shares_ids(tilt_signal()))
    port.stop("the tilt servo sends the ids of curb_frames.hpp");
  const float longest_wait_s = settings.pose.still
                                   ? settings.tilt.max_gap_s
                                   : std::max(settings.tilt.max_gap_s, settings.pose.max_extrapolation_s);
  waiting.init(settings.laser, settings.tilt, settings.pose, longest_wait_s);
  watch.init(settings.tilt.max_gap_s, settings.tilt.fixed);
  nod.init(nod_period_s, settings.tilt.fixed);
  sight.init(settings.tilt.fixed ? longest_bump_s : nod_period_s);
  if (!port.open(tilt_signal())) port.stop("clock, bus or scanner do not start");
}

void take_frames() {
  std::array<can::Frame, 8> frames;
  const int count = port.receive(frames);
  for (const can::Frame& frame : std::span(frames).first(static_cast<std::size_t>(count))) {
    const auto reading = decoder.take(frame);
    if (!reading || !pipeline.add_tilt(*reading)) continue;
    newest.tilt_ns = reading->time_ns;
    nod.update(*reading);
  }
}

void take_poses() {
  while (const auto given = port.pose()) {
    if (!pipeline.add_pose(*given)) continue;
    pose = *given;
    newest.pose_ns = pose.time_ns;
  }
}

/// Informs the motors after a scan line: the curb that the robot meets first, if the laser sees, then the status, whose
/// counter shows whether it does, and whether the tilt rests. A line of a covered laser is taken, but says nothing.
void tell(bool sees) {
  if (sees) {
    const auto ahead = can::curb_ahead_frame(nearest_ahead(pipeline.curbs(), pose, half_width_m));
    if (port.send(ahead)) ++curbs_told;
  }
  const auto curbs = static_cast<std::uint32_t>(pipeline.curbs().size());
  const bool rests = nod.watch().state() == curbline::SourceState::stale;
  port.send(can::curb_status_frame({curbs_told, watch.state(), curbs, rests}));
}

void take_lines() {
  const std::int64_t now_ns = port.now_ns();
  if (const auto line = port.scan_line()) waiting.push(*line, now_ns);
  while (const auto line = waiting.pop(newest, now_ns, pipeline.tilt_latency().latest_offset_s())) {
    watch.update(newest.tilt_ns, now_ns);
    pipeline.take(*line);
    tell(sight.update(pipeline.counters(), line->time_ns));
  }
}

}  // namespace

void curbline::board::leave(int) {
  port.stop("an exception that nobody handles");
}

void curbline::assertion_failed(const char* what) {
  port.stop(what);
}

int main() {
  start();
  for (;;) {
    take_frames();
    take_poses();
    take_lines();
    port.rest();
  }
}
