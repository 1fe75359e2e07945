// What the pipeline dropped, refused or ran into, and how much work it did. Everything only grows, and begins anew at
// 2^32, points of 1081 beams after a day: a reader takes the difference of two snapshots. A healthy robot sees nothing
// but the first group, `no_returns`, `echoes_alone` and `cells_deferred` move.
#pragma once

#include <cstdint>

namespace curbline {

struct Counters {
  // Work.
  std::uint32_t lines = 0;      ///< scan lines taken
  std::uint32_t points = 0;     ///< points that fell in a cell
  std::uint32_t outside = 0;    ///< points outside the window, above its height, or not finite
  std::uint32_t evidences = 0;  ///< plane evidences computed while merging
  std::uint32_t messages = 0;   ///< belief messages that label visits stand for, four each
  // Bad data.
  std::uint32_t no_returns = 0;          ///< beams without a usable range: into the open, too
  std::uint32_t echoes_alone = 0;        ///< in the window, off both beams beside: rain, dust, sun, noise; left out
  std::uint32_t lines_dropped = 0;       ///< see Status of take()
  std::uint32_t beams_without_tilt = 0;  ///< beyond extrapolation or in a gap between readings
  std::uint32_t beams_extrapolated = 0;  ///< beyond the last tilt reading, within the bound
  std::uint32_t tilt_dropped = 0;        ///< readings not finite, not later than the one before, beyond 1e6 rad; as of
                                         ///< the last line
  std::uint32_t lines_off_map = 0;       ///< measured while poses jumped, or the robot climbed, and off by as much:
                                         ///< taken, without points; or, without a map, without those that may be off
  std::uint32_t poses_dropped = 0;       ///< not finite, not later, beyond 1000 km, no attitude, before init()
  // Bounds that were hit.
  std::uint32_t cells_deferred = 0;  ///< labels that waited for a later call (LabelSettings::max_messages)
  std::uint32_t regions_full = 0;    ///< leaves without room, which have no region
  std::uint32_t links_full = 0;      ///< pairs of cells of which the regions' link was left out
  std::uint32_t planes_full = 0;     ///< regions large enough for a plane that got none
  std::uint32_t borders_full = 0;    ///< border points of curbs that were left out
  std::uint32_t curbs_full = 0;      ///< pieces of curb that were not given out
};

}  // namespace curbline
