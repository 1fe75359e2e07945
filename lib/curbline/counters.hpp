// What the pipeline dropped, refused or ran into, and how much work it did. Counters only grow, and wrap at 2^32,
// points of 1081 beams after a day: take the difference of two snapshots. On a healthy robot only the first group,
// `no_returns`, `echoes_alone`, `cells_deferred`, `lines_off_map` while it climbs a curb, and on a drive a few times a
// minute by the chance of its poses, and, without a LineQueue, `beams_extrapolated` move.
#pragma once

#include <cstdint>

namespace curbline {

struct Counters {
  // Work.
  std::uint32_t lines = 0;      ///< scan lines taken
  std::uint32_t points = 0;     ///< points that fell in a cell
  std::uint32_t outside = 0;    ///< points outside the window, above its height, or not finite
  std::uint32_t evidences = 0;  ///< plane evidences computed while merging
  std::uint32_t messages = 0;   ///< belief messages, four for each cell that sends
  // Bad data.
  std::uint32_t no_returns = 0;          ///< beams without a usable range, those into the open included
  std::uint32_t echoes_alone = 0;        ///< left out: lone returns in the window (rain, dust, sun, noise, grass)
  std::uint32_t lines_dropped = 0;       ///< refused by take(), see Status
  std::uint32_t beams_without_tilt = 0;  ///< beyond extrapolation or in a gap between readings
  std::uint32_t beams_extrapolated = 0;  ///< before the first tilt reading or after the last, within the bound
  std::uint32_t tilt_dropped = 0;        ///< readings not finite, not later than the one before, beyond 1e6 rad; as of
                                         ///< the last line
  std::uint32_t lines_off_map = 0;       ///< measured while poses jumped or the robot climbed, and off the map: taken
                                         ///< without points or, where there is no map, without the doubtful ones
  std::uint32_t poses_dropped = 0;       ///< not finite, not later, beyond 1000 km, no unit quaternion, the robot on
                                         ///< its back, before init()
  // Bounds that were hit.
  std::uint32_t cells_deferred = 0;  ///< labels put off to a later call (LabelSettings::max_messages)
  std::uint32_t regions_full = 0;    ///< leaves that found no room, and are in no region
  std::uint32_t links_full = 0;      ///< pairs of cells whose regions were not linked
  std::uint32_t planes_full = 0;     ///< regions large enough for a plane that got none
  std::uint32_t borders_full = 0;    ///< border points left out
  std::uint32_t curbs_full = 0;      ///< pieces of curb left out
};

}  // namespace curbline
