// Curbs for the rest of the robot, as CAN frames: what a motor or brake controller needs to know of the curb ahead,
// without JSON and without Linux. The daemon or firmware sends, after each scan line that says something about the
// window (SightWatch, intake/sight_watch.hpp), a CurbAhead, then a CurbStatus. After any other a CurbStatus alone,
// since nothing new is known about the way: the line was dropped (no tilt, say), or the laser is covered, or has not
// seen the window for longer than a sweep takes. tools/robots/curb_ahead.dbc is their DBC.
//
// "Nothing ahead" means no curb. It is not a clear way: a wall, a step up higher than CurbSettings::max_step_m (0.3 m)
// and ground that was not seen are no curbs either. Whether the way is clear, Pipeline::passable() tells.
//
// Both are standard frames, with ids that CANopen (CiA 301) leaves free and that, of the preset servos, only an ODrive
// with node 53 uses: see shares_ids(). All numbers are little endian, in the base frame, x ahead and y left.
//
// CurbAhead, 0x6A0, 8 bytes: the nearest step on the way or, without one, the nearest crease or ramp edge:
//   bits 0-15   distance_m     u16, 1 mm: x of the point of the curb that is nearest to the robot, 0 to 65.534 m
//   bits 16-31  lateral_m      i16, 1 mm: y of that point, +-32.767 m
//   bits 32-47  height_m       i16, 1 mm: far side less near side, above 0 is a step up
//   bits 48-55  height_sd_m    u8, 1 mm; 255 is 0.255 m or more
//   bits 56-57  kind           0 nothing ahead, 1 step up, 2 step down, 3 crease or edge of a ramp
//   bits 58-63  probability    u6, 0.02, 0 to 1
// CurbStatus, 0x6A1, 3 bytes, so that a receiver can tell "no curb" from "nobody looks":
//   bits 0-7    counter        u8, 255 before the first CurbAhead, one more with each, wraps; a receiver must not trust
//                              CurbAhead while the counter stands still, or without CurbStatus
//   bits 8-9    tilt           0 never seen, 1 ok or fixed, 2 stale: see curbline/intake/source_watch.hpp; 3 at rest,
//                              see curbline/intake/nod_watch.hpp: unless the robot has stopped the servo, its encoder
//                              is stuck, and a receiver must not trust CurbAhead, though the counter advances
//   bits 16-23  curbs          u8, in the window; 255 is 255 or more
//
// Values out of range are clamped; a distance, position or height that is not finite gives "nothing ahead". Functions
// without state: may be called from anywhere. About 200 steps a frame.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "curbline/can/frame.hpp"
#include "curbline/can/signal.hpp"
#include "curbline/curbs/curb_ahead.hpp"
#include "curbline/intake/source_watch.hpp"

namespace curbline::can {

inline constexpr std::uint32_t curb_ahead_id = 0x6A0, curb_status_id = 0x6A1;

struct CurbStatus {
  std::uint8_t counter = 255;  ///< of the last CurbAhead, from 0 on; 255 before the first
  SourceState tilt = SourceState::never;
  std::uint32_t curbs = 0;
  bool resting = false;  ///< the tilt's readings come, but do not change; told if `tilt` is ok
};

/// The frame for a curb or, with nothing, for a way without one.
Frame curb_ahead_frame(const std::optional<CurbAhead>& curb);
Frame curb_status_frame(const CurbStatus& status);

/// Does a servo on the same bus, or its SYNC, use these ids? Then it needs another id: two nodes that send the same id
/// destroy each other's frames. An ODrive, whose signal is one of its frames, has 32 consecutive ids.
bool shares_ids(const Signal& tilt, std::optional<std::uint16_t> sync_id = std::nullopt);

/// Reads the frame. False if it is another one or too short; `curb` is nothing if nothing is ahead.
bool read_curb_ahead(const Frame& frame, std::optional<CurbAhead>& curb);
bool read_curb_status(const Frame& frame, CurbStatus& status);

/// A field of these frames, for their description as DBC.
struct CurbField {
  const char* message;
  const char* name;
  const char* unit;
  const char* meaning;
  Signal signal;
  double minimum, maximum;  ///< of the values sent
};

/// All of them, in the order above; static storage.
std::span<const CurbField> curb_fields();

}  // namespace curbline::can
