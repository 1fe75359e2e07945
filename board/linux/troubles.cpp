#include "troubles.hpp"

#include <cstring>
#include <iterator>
#include <tuple>

namespace curbline::daemon {
namespace {

/// The messages about a servo or a localisation that reports or is silent, a tilt that moves or rests, and a laser that
/// sees or is blind.
struct Told {
  std::string_view missing, first, lost, recovered;
};
constexpr Told servo{"no tilt frame since the start; expected ", "the tilt servo reports", "the tilt servo is silent",
                     "the tilt servo reports again"};
constexpr Told nod{{}, {}, "the tilt rests: the servo has stopped, or its encoder is stuck", "the tilt moves again"};
constexpr Told localisation{"no pose since the start; expected lines of time tx ty tz qx qy qz qw from ",
                            "the localisation gives poses", "the localisation is silent",
                            "the localisation gives poses again"};
constexpr Told laser{{}, {}, "the laser is blind: covered, or it looks beside the window", "the laser sees again"};

void tell_event(SourceEvent event, const Told& told, std::string_view wanted) {
  switch (event) {
    case SourceEvent::none:
      return;
    case SourceEvent::missing:
      return say(told.missing, wanted);
    case SourceEvent::first:
      return say(told.first);
    case SourceEvent::lost:
      return say(told.lost);
    case SourceEvent::recovered:
      return say(told.recovered);
  }
}

}  // namespace

void Troubles::tell(const Report& status, const SourceEvents& events, std::int64_t now_ns) {
  if (status.bus) tell_link(status.bus->link);
  tell_event(events.tilt, servo, status.wanted_tilt);
  tell_event(events.nod, nod, "");
  tell_event(events.poses, localisation, status.poses.wanted);
  tell_event(events.sight, laser, "");
  if (status.scanner != nullptr) tell_scanner(*status.scanner);
  tell_counters(status, now_ns);
}

void Troubles::tell_link(socketcan::LinkState link) {
  if (link == link_) return;
  link_ = link;
  say(link_ == socketcan::LinkState::up     ? "the CAN interface is up again"
      : link_ == socketcan::LinkState::down ? "the CAN interface is down"
                                            : "the CAN interface is gone");
}

void Troubles::tell_scanner(const ScannerState& scanner) {
  if (scanner.connected == scanner_connected_) {
    if (scanner.connected || scanner_told_ || !(scanner.lost || scanner.error != 0 || !scanner.problem.empty())) return;
    scanner_told_ = true;  // it has not been connected since the start
  }
  scanner_connected_ = scanner.connected;
  if (scanner.connected) return say("the scanner gives scan lines");
  scanner_told_ = true;
  const char* const why = scanner.error == 0 ? "it closed the connection" : ::strerrordesc_np(scanner.error);
  say("no scan lines from the scanner ", scanner.name, ": ", std::string_view(why == nullptr ? "unknown error" : why),
      scanner.problem.empty() ? "" : "; ", scanner.problem);
}

void Troubles::tell_counters(const Report& s, std::int64_t now_ns) {
  const socketcan::Counters can = s.bus ? s.bus->counters : socketcan::Counters{};
  const can::TiltDecoderCounters frames = s.tilt_frames == nullptr ? can::TiltDecoderCounters{} : *s.tilt_frames;
  const ScannerState scanner = s.scanner == nullptr ? ScannerState{} : *s.scanner;
  struct Counted {
    std::uint64_t count;
    std::string_view what;
  };
  const Counted all[] = {
      {can.times_bus_off, "the CAN controller has left the bus (bus-off)"},
      {can.restarts, "the CAN controller is back on the bus"},
      {can.bus_errors, "errors on the CAN bus"},
      {can.times_passive, "the CAN controller is error-passive"},
      {can.controller_overruns, "the CAN controller lost frames"},
      {can.frames_lost, "CAN frames were lost in this machine's receive buffer"},
      {can.not_sent, "frames of curbs could not be sent"},
      {frames.malformed, "damaged tilt frames"},
      {frames.without_sync, "tilt frames whose SYNC was not seen"},
      {s.pipeline.tilt_dropped, "tilt readings that are not later than the one before, dropped"},
      {s.poses.damaged, "lines that are no poses, passed over"},
      {s.pipeline.poses_dropped, "poses that are impossible or not later than the one before, dropped"},
      {s.angles_beyond,
       "tilt angles more than a turn from where the sweep began; expected radians, see scale of tilt.signal"},
      {s.tilt_latency == nullptr ? 0 : s.tilt_latency->steps(), "the tilt frames are late by another time"},
      {s.not_recorded, "tilt frames that the recording does not have"},
      {std::uint64_t{s.lines.dropped} + s.lines.crowded, "scan lines came faster than they are taken"},
      {s.lines.bad_time, "scan lines with a damaged stamp, dropped"},
      {s.lines_without_tilt, "scan lines with no tilt angle at their time, dropped; see max_gap_s"},
      {s.lines_without_pose, "scan lines with no pose at their time, dropped"},
      {scanner.other_beams + s.lines.too_long, "scan lines whose beams are not those of the robot's laser, dropped"},
      {scanner.damaged, "damaged telegrams of the scanner"},
      {scanner.device_errors, "faults, or a dirty front screen, that the scanner reports"},
      {s.server.too_slow, "a client was too slow, and dropped"},
      {s.server.refused, "more clients than there is room for"},
  };
  static_assert(std::size(all) == std::tuple_size_v<decltype(counted_)>, "what was told of each lies in counted_");
  for (std::size_t i = 0; i < counted_.size(); ++i) {
    if (counted_[i].is_news(all[i].count, now_ns)) say(all[i].what, " (", all[i].count, " so far)");
  }
}

}  // namespace curbline::daemon
