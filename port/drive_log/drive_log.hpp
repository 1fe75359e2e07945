// A drive as a stream of bytes: the input and output of a board's test. In: the settings, then CAN frames, poses and
// scan lines in the order in which a robot's computer receives them (tools/drive_streams makes it from logs). Out: a
// result per scan line and, from a board with a bus, the frames as it received them. Records are the library's own
// structs as they lie in memory: identical on every little-endian machine that aligns long long and double to 8 bytes,
// as all platforms of this project do. A stream is exchanged between programs of one build; it is not a format for
// storage.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <type_traits>

#include "curbline/can/signal.hpp"
#include "curbline/counters.hpp"
#include "curbline/curbs/curb.hpp"
#include "curbline/pose.hpp"
#include "curbline/scan_line.hpp"
#include "curbline/settings.hpp"
#include "curbline/status.hpp"

namespace curbline::drive_log {

enum class RecordKind : std::uint32_t { setup = 1, can_frame, pose, scan_line, result };

/// Precedes every record; `bytes` bytes follow.
struct RecordHeader {
  RecordKind kind;
  std::uint32_t bytes;
};

/// The first record.
struct Setup {
  Settings settings{};
  can::Signal tilt_signal{};
  std::optional<std::uint16_t> tilt_sync_id{};
};

/// The head of a scan line; the ranges follow as floats, NaN for no return.
struct ScanLineHead {
  std::int64_t time_ns = 0;
};

static_assert(std::is_trivially_copyable_v<Setup> && std::is_trivially_copyable_v<can::Frame> &&
              std::is_trivially_copyable_v<Pose>);
static_assert(sizeof(can::Frame) == 88 && sizeof(Pose) == 40 && alignof(can::Signal) == 8);

/// The pipeline's results after a scan line, byte for byte: header, time, status, counters, number of curbs, curbs.
template <int max_curbs>
class Result {
 public:
  // Offsets from the end of the header, for programs that read results.
  static constexpr std::size_t curbs_at = 12 + sizeof(Counters) + 4;
  static constexpr std::size_t curb_bytes = 9 * sizeof(float) + 4 * sizeof(std::uint16_t);

  Result(const ScanLine& line, Status status, const Counters& counters, std::span<const Curb> curbs) {
    const RecordHeader header{RecordKind::result, 0};
    put(header);
    put(line.time_ns);
    put(static_cast<std::uint32_t>(status));
    put(counters);
    put(static_cast<std::uint32_t>(curbs.size()));
    for (const Curb& curb : curbs) put_curb(curb);
    const auto bytes = static_cast<std::uint32_t>(size_ - sizeof header);
    std::memcpy(bytes_.data() + offsetof(RecordHeader, bytes), &bytes, sizeof bytes);
  }

  std::span<const std::byte> bytes() const { return {bytes_.data(), size_}; }

 private:
  static_assert(sizeof(Counters) % sizeof(std::uint32_t) == 0);

  template <typename T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::memcpy(bytes_.data() + size_, &value, sizeof value);
    size_ += sizeof value;
  }

  void put_curb(const Curb& curb) {
    const auto& [x0, y0, x1, y1, position_sd, height, height_sd, probability, face_width, kind, id, near_label,
                 far_label] = curb;
    for (const float value : {x0, y0, x1, y1, height, height_sd, probability, face_width, position_sd}) put(value);
    using Number = std::uint16_t;
    for (const Number value : {static_cast<Number>(kind), id, Number{near_label}, Number{far_label}}) put(value);
  }

  std::array<std::byte, sizeof(RecordHeader) + curbs_at + static_cast<std::size_t>(max_curbs) * curb_bytes> bytes_;
  std::size_t size_ = 0;
};

}  // namespace curbline::drive_log
