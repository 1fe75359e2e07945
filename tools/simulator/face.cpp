#include "simulator/face.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace curbline::tools {
namespace {

constexpr double least_rise = 1 - 1e-6;  // 45 degrees
constexpr double widest_m = 0.3;         // as CurbSettings::max_step_m: at 45 degrees as high as wide

Point2 between(Point2 a, Point2 b, double share) {
  return a + share * (b - a);
}

/// Unit vector up a slope of 45 degrees or more; {} for flatter regions and the ground without bounds.
Point2 up(const GroundRegion& region) {
  if (region.outline.empty()) return {};
  const Point2 slope = region.plane.slope(region.outline.front());
  const double rise = length(slope);
  return rise < least_rise ? Point2{} : Point2{slope.x / rise, slope.y / rise};
}

/// Width of what is visible of a region, across its longest side; infinite if nothing is. (Not the way uphill: the face
/// of a curb that climbs with its street leans along it, too.)
double width_m(int region, const std::vector<Boundary>& pieces) {
  Point2 along{};
  for (const Boundary& piece : pieces) {
    if (piece.left != region && piece.right != region) continue;
    const Point2 side = piece.to - piece.from;
    if (length(side) > length(along)) along = side;
  }
  double from = std::numeric_limits<double>::infinity(), to = -from;
  for (const Boundary& piece : pieces) {
    if (piece.left != region && piece.right != region) continue;
    for (const Point2 end : {piece.from, piece.to}) {
      from = std::min(from, cross(along, end));
      to = std::max(to, cross(along, end));
    }
  }
  return from > to ? from : (to - from) / length(along);
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
    const double left_m = cross(piece.to - piece.from, way);
    return (to_left ? left_m : -left_m) > touch_m;
  }

  /// Is a piece at the top of a face, as one comes up?
  bool is_top(const Boundary& piece, Point2 uphill) const {
    const bool on_left = is_face(piece.left);
    return on_left != is_face(piece.right) && leads(uphill, piece, !on_left);
  }

  /// The way uphill from a place to a piece's line; infinite if they are parallel.
  static double way_m(Point2 p, Point2 uphill, const Boundary& piece) {
    const Point2 along = piece.to - piece.from;
    return cross(piece.from - p, along) / cross(uphill, along);
  }

  static Point2 half_way(Point2 p, Point2 uphill, const Boundary& top) {
    const double half_m = way_m(p, uphill, top) / 2;
    return p + half_m * uphill;
  }

  /// Where the foot must be cut so that each part has one piece at the top, as shares of its length.
  std::vector<double> cuts_of(const Boundary& foot, Point2 uphill) const {
    std::vector<double> cuts{0, 1};
    const Point2 along = foot.to - foot.from;
    const double near = touch_m / length(along);
    for (const Boundary& piece : pieces_) {
      if (!is_top(piece, uphill)) continue;
      for (const Point2 end : {piece.from, piece.to}) {
        const double share = cross(end - foot.from, uphill) / cross(along, uphill);
        const double up_m = dot(end - between(foot.from, foot.to, share), uphill);
        if (share > near && share < 1 - near && up_m > 0 && up_m < 2 * widest_m) cuts.push_back(share);
      }
    }
    sort_cuts(cuts, length(along));
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
      const Point2 at = p + up_m * uphill;
      if (dot(at - piece.from, at - piece.to) > 0) continue;  // beyond its ends
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
