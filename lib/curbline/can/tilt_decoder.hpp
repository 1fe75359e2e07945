// Frames of a bus in, tilt readings out: the step between a CAN port and Pipeline::add_tilt(). Frames of others are
// passed over, damaged ones dropped, and both are counted. About 200 bytes, no heap, at most 128 steps a frame.
//
// CANopen drives can sample their position on the SYNC frame and send it when the bus is free: then the angle is that
// at the SYNC's time, not at its own arrival, which is up to a millisecond later and jitters. A position whose SYNC was
// not seen is dropped, since its time is unknown: one with no SYNC since the last position, or later after its SYNC
// than the period of SYNCs. That period is the median of the last five gaps, which a lost or repeated SYNC does not
// move; before the second SYNC 5 ms are allowed. (CiA 301, SYNC object 0x1005; TPDO transmission types 1 to 240.)
//
// take() may be called from one interrupt or one receive thread; counters() from anywhere, also during take(). init()
// must not run at the same time as either: call it before the interrupt is enabled, or with it masked.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "curbline/can/frame.hpp"
#include "curbline/can/signal.hpp"
#include "curbline/tilt_reading.hpp"

namespace curbline::can {

/// The SYNC frame's id, unless a CANopen network is configured otherwise.
inline constexpr std::uint16_t default_sync_id = 0x80;

/// Every frame taken is counted in exactly one of the others. All wrap at 2^32.
struct TiltDecoderCounters {
  std::uint32_t frames = 0;
  std::uint32_t readings = 0;      ///< given out
  std::uint32_t others = 0;        ///< another id or multiplexor, remote requests, error messages, SYNC
                                   ///< frames stamped with no time
  std::uint32_t syncs = 0;         ///< SYNC frames
  std::uint32_t malformed = 0;     ///< the servo's, but too short, not finite, no angle of a servo or stamped with no
                                   ///< time (RisingTimes::is_time)
  std::uint32_t without_sync = 0;  ///< the servo's, but its SYNC was not seen
};

class TiltDecoder {
 public:
  /// Starts afresh. With sync_id (11 bits), positions are taken as sampled on that frame. False, and nothing is decoded
  /// until the next init(), if the signal is not valid(), or the id is too large or the signal's own.
  bool init(const Signal& signal, std::optional<std::uint16_t> sync_id = std::nullopt);

  /// The reading in this frame, if it has one. Its time is the frame's, or its SYNC's.
  std::optional<TiltReading> take(const Frame& frame);

  /// A snapshot; each number is whole, and they may be a frame apart.
  TiltDecoderCounters counters() const;

 private:
  bool is_sync(const Frame& frame) const;
  void note_sync(std::int64_t time_ns);
  std::optional<std::int64_t> time_of_position(std::int64_t arrival_ns);
  // Cold: not laid out anew for each of five gaps.
  [[gnu::cold]] std::int64_t sync_period_ns() const;

  Signal signal_{};
  std::optional<std::uint16_t> sync_id_{};
  bool ready_ = false;
  bool sync_pending_ = false;              ///< a SYNC has come since the last position
  std::optional<std::int64_t> sync_ns_{};  ///< time of the newest SYNC
  std::array<std::int64_t, 5> gaps_ns_{};  ///< between the newest ones, a ring
  std::size_t gaps_ = 0;                   ///< in the ring
  std::size_t next_gap_ = 0;               ///< which is replaced next
  mutable TiltDecoderCounters counters_{};
};

}  // namespace curbline::can
