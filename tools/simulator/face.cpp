#include "simulator/face.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace curbline::tools {
namespace {

constexpr double least_rise = 1 - 1e-6;  // 45 degrees
constexpr double widest_m = 0.3;         // as CurbSettings::max_step_m: at 45 degrees as high as wide
constexpr double touch_m = 1e-6;

struct Extent {
  double from_m = std::numeric_limits<double>::infinity(), to_m = -from_m;
  void add(double at_m) { from_m = std::min(from_m, at_m), to_m = std::max(to_m, at_m); }
};

double dot(Point2 a, Point2 b) {
  return a.x * b.x + a.y * b.y;
}

double cross(Point2 a, Point2 b) {
  return a.x * b.y - a.y * b.x;
}

Point2 from_to(Point2 a, Point2 b) {
  return {b.x - a.x, b.y - a.y};
}

Point2 between(Point2 a, Point2 b, double share) {
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}

/// Unit vector up a slope of 45 degrees or more; {} for flatter regions and the ground without bounds.
Point2 up(const GroundRegion& region) {
  if (region.outline.empty()) return {};
  const Point2 slope = region.plane.slope(region.outline.front());
  const double rise = std::hypot(slope.x, slope.y);
  return rise < least_rise ? Point2{} : Point2{slope.x / rise, slope.y / rise};
}

/// Width of what is visible of a region, across its longest side; infinite if nothing is. (Not the way uphill: the face
/// of a curb that climbs with its street leans along it, too.)
double width_m(int region, const std::vector<Boundary>& pieces) {
  Point2 along{};
  for (const Boundary& piece : pieces) {
    if (piece.left != region && piece.right != region) continue;
    const Point2 side = from_to(piece.from, piece.to);
    if (dot(side, side) > dot(along, along)) along = side;
  }
  Extent across;
  for (const Boundary& piece : pieces) {
    if (piece.left != region && piece.right != region) continue;
    for (const Point2 end : {piece.from, piece.to}) across.add(cross(along, end) / std::hypot(along.x, along.y));
  }
  return across.from_m > across.to_m ? across.from_m : across.to_m - across.from_m;
}

/// The steps across faces.
class Across {
 public:
  Across(const std::vector<GroundRegion>& regions, const std::vector<Boundary>& pieces, const std::vector<bool>& faces)
      : regions_(regions), pieces_(pieces), faces_(faces) {}

  bool is_face(int region) const { return region >= 0 && faces_[static_cast<std::size_t>(region)]; }

  /// Those from a piece at the foot of a face; none for another piece.
  void append(const Boundary& foot, std::vector<Boundary>& out) const {
    const bool on_left = is_face(foot.left);
    if (on_left == is_face(foot.right)) return;
    const Point2 uphill = up(regions_[static_cast<std::size_t>(on_left ? foot.left : foot.right)]);
    if (!leads(uphill, foot, on_left)) return;
    const std::vector<double> cuts = cuts_of(foot, uphill);
    for (std::size_t i = 1; i < cuts.size(); ++i) {
      const Point2 from = between(foot.from, foot.to, cuts[i - 1]), to = between(foot.from, foot.to, cuts[i]);
      const Boundary* top = top_above(between(from, to, 0.5), uphill);
      if (top == nullptr) continue;
      const int beyond = is_face(top->left) ? top->right : top->left;
      out.push_back({half_way(from, uphill, *top), half_way(to, uphill, *top), on_left ? beyond : foot.left,
                     on_left ? foot.right : beyond});
    }
  }

 private:
  /// Does a direction lead over a piece to its left, or else to its right?
  static bool leads(Point2 way, const Boundary& piece, bool to_left) {
    const double left_m = cross(from_to(piece.from, piece.to), way);
    return (to_left ? left_m : -left_m) > touch_m;
  }

  /// Is a piece at the top of a face, as one comes up?
  bool is_top(const Boundary& piece, Point2 uphill) const {
    const bool on_left = is_face(piece.left);
    return on_left != is_face(piece.right) && leads(uphill, piece, !on_left);
  }

  /// The way uphill from a place to a piece's line; infinite if they are parallel.
  static double way_m(Point2 p, Point2 uphill, const Boundary& piece) {
    const Point2 along = from_to(piece.from, piece.to);
    return cross(from_to(p, piece.from), along) / cross(uphill, along);
  }

  static Point2 half_way(Point2 p, Point2 uphill, const Boundary& top) {
    const double half_m = way_m(p, uphill, top) / 2;
    return {p.x + half_m * uphill.x, p.y + half_m * uphill.y};
  }

  /// Where the foot must be cut so that each part has one piece at the top, as shares of its length.
  std::vector<double> cuts_of(const Boundary& foot, Point2 uphill) const {
    std::vector<double> cuts{0, 1};
    const Point2 along = from_to(foot.from, foot.to);
    const double near = touch_m / std::hypot(along.x, along.y);
    for (const Boundary& piece : pieces_) {
      if (!is_top(piece, uphill)) continue;
      for (const Point2 end : {piece.from, piece.to}) {
        const double share = cross(from_to(foot.from, end), uphill) / cross(along, uphill);
        const double up_m = dot(from_to(between(foot.from, foot.to, share), end), uphill);
        if (share > near && share < 1 - near && up_m > 0 && up_m < 2 * widest_m) cuts.push_back(share);
      }
    }
    std::sort(cuts.begin(), cuts.end());
    cuts.erase(std::unique(cuts.begin(), cuts.end(), [near](double a, double b) { return b - a < near; }), cuts.end());
    return cuts;
  }

  /// The nearest piece at the top, uphill from a place at the foot, where ground begins; null if there is none.
  const Boundary* top_above(Point2 p, Point2 uphill) const {
    const Boundary* nearest = nullptr;
    double least_m = 2 * widest_m;  // of two faces, one above the other
    for (const Boundary& piece : pieces_) {
      if (!is_top(piece, uphill)) continue;
      const double up_m = way_m(p, uphill, piece);
      if (!(up_m > touch_m) || up_m >= least_m) continue;
      const Point2 at{p.x + up_m * uphill.x, p.y + up_m * uphill.y};
      if (dot(from_to(piece.from, at), from_to(piece.to, at)) > 0) continue;  // beyond its ends
      least_m = up_m;
      nearest = &piece;
    }
    return nearest;
  }

  const std::vector<GroundRegion>& regions_;
  const std::vector<Boundary>& pieces_;
  const std::vector<bool>& faces_;
};

}  // namespace

std::vector<bool> faces_of(const std::vector<GroundRegion>& regions, const std::vector<Boundary>& pieces) {
  std::vector<bool> faces(regions.size());
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const Point2 uphill = up(regions[r]);
    faces[r] = dot(uphill, uphill) > 0 && width_m(static_cast<int>(r), pieces) <= widest_m + touch_m;
  }
  return faces;
}

std::vector<Boundary> across_faces(const std::vector<GroundRegion>& regions, const std::vector<Boundary>& pieces,
                                   const std::vector<bool>& faces) {
  const Across across(regions, pieces, faces);
  std::vector<Boundary> out;
  for (const Boundary& piece : pieces) {
    if (!across.is_face(piece.left) && !across.is_face(piece.right)) {
      out.push_back(piece);
    } else {
      across.append(piece, out);
    }
  }
  return out;
}

}  // namespace curbline::tools
