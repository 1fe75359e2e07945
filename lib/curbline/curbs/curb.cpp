#include "curbline/curbs/curb.hpp"

#include <algorithm>
#include <limits>

namespace curbline {
namespace {

/// The coordinates of a place relative to a piece: along it, from its first end, and to its left, the far side.
struct Line {
  explicit Line(const Curb& curb)
      : x0_m(curb.x0_m),
        y0_m(curb.y0_m),
        dx_m(curb.x1_m - curb.x0_m),
        dy_m(curb.y1_m - curb.y0_m),
        length_m(length_of(curb)) {}

  float along_m(float x_m, float y_m) const { return ((x_m - x0_m) * dx_m + (y_m - y0_m) * dy_m) / length_m; }
  float left_m(float x_m, float y_m) const { return ((y_m - y0_m) * dx_m - (x_m - x0_m) * dy_m) / length_m; }
  /// The middle of a piece.
  float left_m(const Curb& of) const { return left_m(0.5f * (of.x0_m + of.x1_m), 0.5f * (of.y0_m + of.y1_m)); }
  /// Length of a piece that lies along this one, in projection; 0 or less if none does.
  float overlap_m(const Curb& of) const {
    const float a = along_m(of.x0_m, of.y0_m), b = along_m(of.x1_m, of.y1_m);
    return std::min(length_m, std::max(a, b)) - std::max(0.0f, std::min(b, a));
  }

  float x0_m, y0_m, dx_m, dy_m, length_m;
};

}  // namespace

const char* to_string(CurbKind kind) {
  switch (kind) {
    case CurbKind::step_up:
      return "step_up";
    case CurbKind::step_down:
      return "step_down";
    case CurbKind::crease:
      return "crease";
    case CurbKind::ramp_edge:
      return "ramp_edge";
  }
  return "unknown";
}

float to_far_side_m(const Curb& curb, float x_m, float y_m) {
  const Line line(curb);
  const float along_m = line.along_m(x_m, y_m);
  return along_m >= 0.0f && along_m <= line.length_m ? line.left_m(x_m, y_m) : std::numeric_limits<float>::infinity();
}

float overlap_m(const Curb& now, const Curb& before, float near_m) {
  const Line line(before);
  if (!(line.length_m > 0.0f) || magnitude(line.left_m(now)) > near_m) return 0.0f;
  return line.overlap_m(now);
}

float likeness_m(const Curb& now, const Curb& before, float near_m) {
  const Line line(before), of_now(now);
  const float aside_m = magnitude(line.left_m(now));
  if (!(line.length_m > 0.0f) || aside_m > near_m) return 0.0f;
  const float along_m2 = line.dx_m * of_now.dx_m + line.dy_m * of_now.dy_m;
  if (square(along_m2) < 0.5f * square(line.length_m * of_now.length_m)) return 0.0f;
  return line.overlap_m(now) * (1.0f - aside_m / near_m);
}

}  // namespace curbline
