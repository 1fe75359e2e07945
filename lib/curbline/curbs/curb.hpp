// What the pipeline gives out: a piece of curb, its kind, and how two of them are told to be one.
#pragma once

#include <cstdint>
#include <span>

#include "curbline/grid.hpp"
#include "curbline/line_fit.hpp"
#include "curbline/math.hpp"
#include "curbline/plane.hpp"

namespace curbline {

enum class CurbKind : std::uint8_t {
  step_up,    ///< the far side is higher
  step_down,  ///< the far side is lower
  crease,     ///< planes of different slope that may meet at one height: a gutter, a change of cross-fall; and the end
              ///< of a face beyond which no ground is seen
  ramp_edge,  ///< a crease of which one side alone rises or falls away from it by more than 1 in 20: a ramp, by ISO
              ///< 21542
};
const char* to_string(CurbKind kind);

/// A straight piece of curb line, in the map frame. Near is the side of the robot, and lies to the right of the way
/// from (x0, y0) to (x1, y1). It ends half a cell beyond where both sides are seen; up to half of
/// CurbSettings::link_reach farther if one is hidden there.
struct Curb {
  float x0_m = 0.0f, y0_m = 0.0f, x1_m = 0.0f, y1_m = 0.0f;
  float position_sd_m = 0.0f;  ///< across it, of its middle; twice that at its ends
  float height_m = 0.0f;  ///< far plane less near plane, in the middle of the piece and of the gap between them, of a
                          ///< step with a shadow at its edge; along the piece it changes by 2 cm at most; more where
                          ///< the ground beside it lies farther apart than its planes, as in a gutter; above 0 is a
                          ///< step up; 0 of a crease or the edge of a ramp
  float height_sd_m = 0.0f;   ///< from both planes' posteriors and roughness, from how far and how often they were
                              ///< seen, what the piece's place leaves open where their slopes differ, how much the
                              ///< step grows along it if they were seen from several places, and how far the cells
                              ///< beside the border lie off them
  float probability = 0.0f;   ///< that the cells on both sides lie on different planes, mean along the piece
  float face_width_m = 0.0f;  ///< across the piece, between the cells of both planes, less the shadow of a step
                              ///< down: to a cell; 0 of the end of a face
  CurbKind kind = CurbKind::crease;
  /// The same as long as the curb is found, 1 to 65535; may be given anew when that many have been.
  std::uint16_t id = 0;
  /// Far is no_label where no ground is seen beyond: at the end of a face, and at a brink, a step down of which the
  /// height is what is seen of it, the mean along the piece, and the standard deviation as if up to as much again were
  /// hidden.
  Label near_label = 0, far_label = 0;
};

inline bool is_step(const Curb& curb) {
  return curb.kind == CurbKind::step_up || curb.kind == CurbKind::step_down;
}

/// Metres.
inline float length_of(const Curb& curb) {
  return square_root(square(curb.x1_m - curb.x0_m) + square(curb.y1_m - curb.y0_m));
}

/// How far a place beside a piece lies from its line, toward the far side; below 0 on the near one. Infinite beyond its
/// ends.
float to_far_side_m(const Curb& curb, float x_m, float y_m);

/// How much of `now` lies along `before`, metres: of its projection, if its middle lies within `near_m` of that line.
/// Else 0 or less.
float overlap_m(const Curb& now, const Curb& before, float near_m);

/// Cells that an edge crosses may bear a third plane, and part it from one of the others: a second step, of another
/// height, within a cell of the first. Of steps that lie along each other, all but a cell of the shorter, the longer
/// one tells the edge, of equals the first. Says for each curb whether another tells it; O(curbs^2).
void told_by_longer(std::span<const Curb> curbs, float cell_m, std::span<bool> told);

/// A border as it was drawn between two planes.
struct DrawnBorder {
  float height_m, height_sd_m;  ///< second plane less first there
  float half_gap_m;             ///< between the cells of the one and the other
  float place_variance_m2;      ///< of where the border lies, across it
  float texture_m2;             ///< of the ground, PlanePrior::texture_m2
};

/// Planes of different slope make a crease where they meet. A border between them is one if they differ in height there
/// by no more than is not known (95 %): of the planes, of the cells by which the border was drawn, which err by the
/// ground's texture at least, and of its place, by which their slopes make them differ. A face, too steep for ground,
/// begins at its foot, anywhere in the gap: as much more as the slopes make up across half of it. CurbKind::step_up
/// stands for either step.
CurbKind kind_of(const Plane& first, const Plane& second, const LineFit::Segment& border, const DrawnBorder& drawn);

}  // namespace curbline
