// Runs a drive: passes the records of drive_log.hpp to the pipeline and writes a result after each scan line. The code
// is the same on a desk and on every board, so that the results can be compared byte by byte. Nothing is allocated.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "curbline/can/tilt_decoder.hpp"
#include "curbline/pipeline.hpp"
#include "drive_log/drive_log.hpp"
#ifdef CURBLINE_ROBOT
#include "robot.hpp"
#endif

namespace curbline::board {

/// Sizes of the boards' pipeline: those of a robot (robot.hpp of the template, or of its copy), else 40 x 40 cells, 16
/// planes, 1081 beams, for which the budgets hold.
#ifdef CURBLINE_ROBOT
using ::limits;
#else
inline constexpr Limits limits{};
#endif

using drive_log::RecordHeader;
using drive_log::RecordKind;

/// How a drive ended. Anything but `done` says what was wrong with the stream.
enum class DriveEnd : std::uint8_t {
  done,
  cut_record,
  no_setup,
  other_build,
  setup_refused,
  no_bus,
  unknown_record,
  no_room_for_results
};
const char* to_string(DriveEnd end);

/// Source of bytes and sink for results; see port/README.md. read(span) fills the whole span, or returns how many bytes
/// it got before the end; write(span) returns false on failure.
template <typename Stream>
concept ByteStream = requires(Stream& stream, std::span<std::byte> in, std::span<const std::byte> out) {
  { stream.read(in) } -> std::same_as<std::size_t>;
  { stream.write(out) } -> std::same_as<bool>;
};

/// How the drive's CAN frames reach the pipeline. open() gets the servo's signal. carry() transports a frame and calls
/// take(frame) with what was received: never, once or several times. Both return false if the bus fails.
template <typename Bus>
concept FrameWay = requires(Bus& bus, const can::Signal& signal, const can::Frame& frame,
                            void (*take)(const can::Frame&)) {
  { bus.open(signal) } -> std::same_as<bool>;
  { bus.carry(frame, take) } -> std::same_as<bool>;
};

/// Passes frames on unchanged.
struct NoBus {
  bool open(const can::Signal&) { return true; }
  bool carry(const can::Frame& frame, auto&& take) { return take(frame), true; }
};

template <ByteStream Stream, FrameWay Bus = NoBus>
class Drive {
 public:
  Drive(Stream& stream, Pipeline<limits>& pipeline, Bus bus = {}) : stream_(stream), pipeline_(pipeline), bus_(bus) {}

  /// Runs to the end of the stream.
  DriveEnd run();

 private:
  enum class Got : std::uint8_t { record, end, cut };

  Got read_header(RecordHeader& header);
  template <typename T>
  bool read(T& value, std::size_t bytes) {
    return bytes == sizeof value && stream_.read(std::as_writable_bytes(std::span<T, 1>(&value, 1))) == sizeof value;
  }
  DriveEnd set_up();
  DriveEnd take(const RecordHeader& header);
  DriveEnd take_frame(std::size_t bytes);
  DriveEnd take_line(std::size_t bytes);
  bool end_line(const ScanLine& line, Status status);

  Stream& stream_;
  Pipeline<limits>& pipeline_;
  Bus bus_;
  can::TiltDecoder tilt_decoder_{};
  std::array<float, limits.beams> ranges_m_{};
};

template <ByteStream Stream, FrameWay Bus>
DriveEnd Drive<Stream, Bus>::run() {
  if (const DriveEnd end = set_up(); end != DriveEnd::done) return end;
  RecordHeader header;
  for (Got got = read_header(header); got != Got::end; got = read_header(header)) {
    if (got == Got::cut) return DriveEnd::cut_record;
    if (const DriveEnd end = take(header); end != DriveEnd::done) return end;
  }
  return DriveEnd::done;
}

template <ByteStream Stream, FrameWay Bus>
auto Drive<Stream, Bus>::read_header(RecordHeader& header) -> Got {
  const std::size_t bytes = stream_.read(std::as_writable_bytes(std::span(&header, 1)));
  return bytes == sizeof header ? Got::record : bytes == 0 ? Got::end : Got::cut;
}

template <ByteStream Stream, FrameWay Bus>
DriveEnd Drive<Stream, Bus>::set_up() {
  RecordHeader header;
  if (read_header(header) != Got::record || header.kind != RecordKind::setup) return DriveEnd::no_setup;
  if (header.bytes != sizeof(drive_log::Setup)) return DriveEnd::other_build;
  drive_log::Setup setup;
  if (!read(setup, header.bytes)) return DriveEnd::cut_record;
  const bool servo = setup.settings.tilt.fixed || tilt_decoder_.init(setup.tilt_signal, setup.tilt_sync_id);
  if (!servo || pipeline_.init(setup.settings) != Status::ok) return DriveEnd::setup_refused;
  return bus_.open(setup.tilt_signal) ? DriveEnd::done : DriveEnd::no_bus;
}

template <ByteStream Stream, FrameWay Bus>
DriveEnd Drive<Stream, Bus>::take(const RecordHeader& header) {
  switch (header.kind) {
    case RecordKind::can_frame:
      return take_frame(header.bytes);
    case RecordKind::pose: {
      Pose pose;
      if (!read(pose, header.bytes)) return DriveEnd::cut_record;
      pipeline_.add_pose(pose);
      return DriveEnd::done;
    }
    case RecordKind::scan_line:
      return take_line(header.bytes);
    default:
      return DriveEnd::unknown_record;
  }
}

template <ByteStream Stream, FrameWay Bus>
DriveEnd Drive<Stream, Bus>::take_frame(std::size_t bytes) {
  can::Frame sent;
  if (!read(sent, bytes)) return DriveEnd::cut_record;
  const bool carried = bus_.carry(sent, [this](const can::Frame& frame) {
    if (const std::optional<TiltReading> reading = tilt_decoder_.take(frame)) pipeline_.add_tilt(*reading);
  });
  return carried ? DriveEnd::done : DriveEnd::no_bus;
}

template <ByteStream Stream, FrameWay Bus>
DriveEnd Drive<Stream, Bus>::take_line(std::size_t bytes) {
  drive_log::ScanLineHead head;
  if (bytes < sizeof head || (bytes - sizeof head) % sizeof(float) != 0) return DriveEnd::cut_record;
  const std::size_t beams = (bytes - sizeof head) / sizeof(float);
  if (beams > ranges_m_.size()) return DriveEnd::other_build;
  const std::span<float> ranges_m = std::span(ranges_m_).first(beams);
  if (!read(head, sizeof head) || stream_.read(std::as_writable_bytes(ranges_m)) != ranges_m.size_bytes())
    return DriveEnd::cut_record;
  const ScanLine line{head.time_ns, ranges_m};
  const Status status = pipeline_.take(line);
  return end_line(line, status) ? DriveEnd::done : DriveEnd::no_room_for_results;
}

/// Not inlined: tools/budget separates scan lines by the calls of this function.
template <ByteStream Stream, FrameWay Bus>
[[gnu::noinline]] bool Drive<Stream, Bus>::end_line(const ScanLine& line, Status status) {
  const drive_log::Result<limits.curbs> result(line, status, pipeline_.counters(), pipeline_.curbs());
  return stream_.write(result.bytes());
}

}  // namespace curbline::board

extern template class curbline::Pipeline<curbline::board::limits>;  // in drive.cpp
