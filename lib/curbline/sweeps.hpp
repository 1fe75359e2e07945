// The latest three sweeps of the tilt. A cell's ground may be of all of them, and each is late in its own way.
#pragma once

namespace curbline {

/// Something of this sweep, of the last one, and of the one before that, which went this one's way.
struct BySweep {
  float now = 0.0f, last = 0.0f, before = 0.0f;
};

/// How fast the sweeps were that have mapped the ground: by this, a cell's growth is divided between their directions
/// (Dem::growths_m_s()).
struct SweepRates {
  float last_rad_s = 0.0f;  ///< mean of the last sweep
  float this_share = 0.5f;  ///< rate of the sweep before it, which went this one's way, in the difference of both
};

}  // namespace curbline
