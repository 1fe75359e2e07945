// What the pipeline gives out: a straight piece of curb, its kind, and how a place or another piece lies to it.
#pragma once

#include <cstdint>

#include "curbline/grid.hpp"
#include "curbline/math.hpp"

namespace curbline {

enum class CurbKind : std::uint8_t {
  step_up,    ///< the far side is higher
  step_down,  ///< the far side is lower
  crease,  ///< planes of different slope that may meet at one height: a gutter, a change of cross-fall; also the end of
           ///< a curb's face with no ground in view beyond
  ramp_edge,  ///< a crease of which exactly one side rises or falls away by more than 1 in 20: a ramp, by ISO 21542
};
const char* to_string(CurbKind kind);

/// A straight piece of curb line, in the map frame. The near side is the robot's; it lies to the right, looking from
/// (x0, y0) to (x1, y1). Where the line, continued, may pass the robot on either side, as that of a short piece far
/// away along the curb, it is that of the ground below the robot, if that is in view and one of the two. A piece ends
/// half a cell beyond where both sides are seen, or up to half of CurbSettings::link_reach farther if one is hidden
/// there.
struct Curb {
  float x0_m = 0.0f, y0_m = 0.0f, x1_m = 0.0f, y1_m = 0.0f;
  float position_sd_m = 0.0f;  ///< across the piece, at its middle; twice that at its ends
  float height_m = 0.0f;  ///< far side less near side, at the piece's middle: above 0 is a step up; 0 for a crease or a
                          ///< ramp edge. It is that of the planes, in the middle of the gap between them or, of a step
                          ///< with a shadow, at its edge, unless the ground next to the curb deviates from its plane,
                          ///< as in a gutter. Along a piece of three cells or more it changes by at most 2 cm
  float height_sd_m = 0.0f;   ///< of that: both planes' posteriors and roughness, the ground next to the curb, a slope
                              ///< between the planes, what is unseen of a face that a sweep has just come upon, and
                              ///< the piece's position where slopes differ (lib/formulas.md)
  float probability = 0.0f;   ///< that the cells on both sides belong to different planes, mean along the piece; 0 to 1
  float face_width_m = 0.0f;  ///< between the cells of both planes, across the piece, less the shadow of a step down;
                              ///< resolves a cell; 0 for the end of a face
  CurbKind kind = CurbKind::crease;
  /// Stays the same as long as the curb is found; 1 to 65535, reused after that many.
  std::uint16_t id = 0;
  /// far_label is no_label where no ground is in view beyond: at the end of a face, and at a brink. The height of a
  /// brink, a step down, is as much as is visible of it, mean along the piece; its standard deviation allows for as
  /// much again.
  Label near_label = 0, far_label = 0;
};

inline bool is_step(const Curb& curb) {
  return curb.kind == CurbKind::step_up || curb.kind == CurbKind::step_down;
}

/// Metres.
inline float length_of(const Curb& curb) {
  return square_root(square(curb.x1_m - curb.x0_m) + square(curb.y1_m - curb.y0_m));
}

/// Distance of a place from a piece's line, positive on the far side, negative on the near one; infinite beyond the
/// piece's ends.
float to_far_side_m(const Curb& curb, float x_m, float y_m);

/// Length of `now` that lies along `before`, in projection, if its middle is within `near_m` of that line; else 0 or
/// less.
float overlap_m(const Curb& now, const Curb& before, float near_m);

/// How much speaks for `now` being the curb that was `before`: that overlap, the less the farther aside it lies, to 0
/// at near_m; 0 or less if they run at more than 45 degrees to each other.
float likeness_m(const Curb& now, const Curb& before, float near_m);

}  // namespace curbline
