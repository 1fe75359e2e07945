#include "reports.hpp"

#include "json_line.hpp"

namespace curbline::daemon {
namespace {

std::string_view word_of(SourceState state) {
  return state == SourceState::ok ? "ok" : state == SourceState::stale ? "stale" : "never";
}

std::string_view word_of(socketcan::LinkState state) {
  return state == socketcan::LinkState::up ? "up" : state == socketcan::LinkState::down ? "down" : "gone";
}

std::string_view word_of(socketcan::BusState state) {
  using socketcan::BusState;
  return state == BusState::active    ? "active"
         : state == BusState::warning ? "warning"
         : state == BusState::passive ? "passive"
                                      : "off";
}

void put(JsonLine& json, std::string_view key, std::uint64_t count) {
  json.key(key).whole(static_cast<std::int64_t>(count));
}

void put_watch(JsonLine& json, const SourceWatch& watch) {
  json.key("state").text(word_of(watch.state()));
  put(json, "times_lost", watch.times_lost());
  json.key("longest_silence_s").real(1e-9 * static_cast<double>(watch.longest_silence_ns()));
}

void put_tilt(JsonLine& json, const Report& s) {
  json.key("tilt").open('{');
  put_watch(json, *s.tilt);
  if (s.nod != nullptr) put(json, "times_rested", s.nod->times_lost());
  put(json, "frames", s.tilt_frames->frames);
  put(json, "readings", s.tilt_frames->readings);
  put(json, "others", s.tilt_frames->others);
  put(json, "malformed", s.tilt_frames->malformed);
  put(json, "without_sync", s.tilt_frames->without_sync);
  put(json, "dropped", s.pipeline.tilt_dropped);
  put(json, "beyond_a_turn", s.angles_beyond);
  const TiltLatency::Usual late = s.tilt_latency->usual();
  json.key("latency_offset_s").real(late.offset_s).key("latency_sd_s").real(late.sd_s);
  put(json, "latency_steps", s.tilt_latency->steps());
  json.close('}');
}

void put_poses(JsonLine& json, const Report& s) {
  json.key("poses").open('{');
  put_watch(json, *s.poses.watch);
  put(json, "taken", s.poses.taken);
  put(json, "damaged", s.poses.damaged);
  put(json, "dropped", s.pipeline.poses_dropped);
  json.close('}');
}

void put_bus(JsonLine& json, const BusReport& bus) {
  const socketcan::Counters& c = bus.counters;
  json.key("can").open('{').key("link").text(word_of(bus.link)).key("bus").text(word_of(bus.state));
  put(json, "frames", c.frames);
  put(json, "frames_lost", c.frames_lost);
  put(json, "error_messages", c.error_messages);
  put(json, "bus_errors", c.bus_errors);
  put(json, "controller_overruns", c.controller_overruns);
  put(json, "times_passive", c.times_passive);
  put(json, "times_bus_off", c.times_bus_off);
  put(json, "restarts", c.restarts);
  put(json, "times_down", c.times_down);
  put(json, "times_gone", c.times_gone);
  put(json, "times_back", c.times_back);
  put(json, "sent", c.sent);
  put(json, "not_sent", c.not_sent);
  json.close('}');
}

void put_lines(JsonLine& json, const Report& s) {
  json.key("scans").open('{');
  if (s.scanner != nullptr) {
    json.key("connected").boolean(s.scanner->connected);
    put(json, "connections", s.scanner->connections);
    put(json, "damaged", s.scanner->damaged);
    put(json, "other_beams", s.scanner->other_beams);
    put(json, "device_errors", s.scanner->device_errors);
  }
  put(json, "lines", s.lines.pushed);
  put(json, "covered", s.lines.covered);
  put(json, "overdue", s.lines.overdue);
  put(json, "crowded", s.lines.crowded);
  put(json, "dropped", s.lines.dropped);
  put(json, "bad_time", s.lines.bad_time);
  put(json, "too_long", s.lines.too_long);
  json.close('}');
}

void put_sight(JsonLine& json, const SourceWatch& sight) {
  json.key("sight").open('{');
  put_watch(json, sight);
  json.close('}');
}

void put_pipeline(JsonLine& json, const Report& s) {
  json.key("pipeline").open('{');
  put(json, "lines", s.pipeline.lines);
  put(json, "points", s.pipeline.points);
  put(json, "no_returns", s.pipeline.no_returns);
  put(json, "lines_dropped", s.pipeline.lines_dropped);
  put(json, "lines_without_tilt", s.lines_without_tilt);
  put(json, "lines_without_pose", s.lines_without_pose);
  put(json, "beams_without_tilt", s.pipeline.beams_without_tilt);
  put(json, "beams_extrapolated", s.pipeline.beams_extrapolated);
  put(json, "curbs", s.curbs);
  put(json, "curbs_left_out", s.curbs_left_out);
  json.close('}');
}

void put_clients(JsonLine& json, const Report& s) {
  json.key("clients").open('{');
  put(json, "connected", static_cast<std::uint64_t>(s.clients));
  put(json, "accepted", s.server.accepted);
  put(json, "too_slow", s.server.too_slow);
  put(json, "refused", s.server.refused);
  json.close('}');
}

void put_histogram(JsonLine& json, std::string_view key, const LatencyHistogram& h) {
  json.key(key).open('{');
  put(json, "samples", h.samples());
  put(json, "mean", h.mean_us());
  put(json, "p50", h.quantile_us(500));
  put(json, "p99", h.quantile_us(990));
  put(json, "max", h.longest_us());
  json.key("below").open('[');
  for (std::size_t i = 0; i < LatencyHistogram::buckets; ++i) {
    if (h.count(i) == 0) continue;
    json.open('[').whole(static_cast<std::int64_t>(LatencyHistogram::end_us(i)));
    json.whole(static_cast<std::int64_t>(h.count(i))).close(']');
  }
  json.close(']').close('}');
}

void put_curb(JsonLine& json, const Curb& c) {
  json.open('{').key("x0_m").real(c.x0_m).key("y0_m").real(c.y0_m).key("x1_m").real(c.x1_m);
  json.key("y1_m").real(c.y1_m).key("position_sd_m").real(c.position_sd_m);
  json.key("height_m").real(c.height_m).key("height_sd_m").real(c.height_sd_m);
  json.key("probability").real(c.probability).key("kind").text(to_string(c.kind));
  json.key("face_width_m").real(c.face_width_m).key("id").whole(c.id).close('}');
}

}  // namespace

std::string_view state_of(const Report& s) {
  if (s.bus && s.bus->link != socketcan::LinkState::up) return "can_down";
  if (s.bus && s.bus->state == socketcan::BusState::off) return "bus_off";
  if (s.tilt != nullptr && s.tilt->state() != SourceState::ok) {
    return s.tilt->state() == SourceState::stale ? "tilt_stale" : "tilt_missing";
  }
  if (s.poses.watch != nullptr && s.poses.watch->state() != SourceState::ok) {
    return s.poses.watch->state() == SourceState::stale ? "poses_stale" : "poses_missing";
  }
  if (s.scanner != nullptr && !s.scanner->connected) return "scanner_lost";
  if (s.angles_in_doubt) return "tilt_not_radians";
  if (s.sight != nullptr && s.sight->state() == SourceState::stale) return "laser_blind";
  if (s.nod != nullptr && s.nod->state() == SourceState::stale) return "tilt_resting";
  return "ok";
}

std::string_view status_line(const Report& s, std::span<char> buffer) {
  JsonLine json(buffer);
  json.open('{').key("status").open('{').key("state").text(state_of(s)).key("time_s").seconds(s.time_ns);
  json.key("uptime_s").real(s.uptime_s);
  if (s.tilt != nullptr) put_tilt(json, s);
  if (s.poses.watch != nullptr) put_poses(json, s);
  if (s.bus) put_bus(json, *s.bus);
  put_lines(json, s);
  if (s.sight != nullptr) put_sight(json, *s.sight);
  put_pipeline(json, s);
  put_clients(json, s);
  json.key("microseconds").open('{').key("scan_line").whole(static_cast<std::int64_t>(s.scan_line_s * 1e6));
  if (s.latency != nullptr) put_histogram(json, "tilt_frame_to_curbs", *s.latency);
  put_histogram(json, "pipeline", *s.work);
  json.close('}');
  json.key("heap_calls").open('{');
  put(json, "before_start", s.heap_calls_before);
  put(json, "since_start", s.heap_calls_since);
  json.close('}').close('}').close('}');
  return json.end();
}

std::string_view curbs_line(std::int64_t time_ns, std::span<const Curb> curbs, std::span<char> buffer,
                            std::uint32_t& left_out) {
  JsonLine json(buffer);
  json.open('{').key("time_s").seconds(time_ns).key("curbs").open('[');
  for (const Curb& curb : curbs) {
    const JsonLine::Mark before = json.mark();
    put_curb(json, curb);
    if (!json.full()) continue;
    json.cut(before);
    ++left_out;
  }
  json.close(']').close('}');
  return json.end();
}

}  // namespace curbline::daemon
