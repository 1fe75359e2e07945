#include "simulator/boundary.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace curbline::tools {
namespace {

constexpr double aside_m = 1e-5;  // how far to either side of an edge its regions are looked up

struct Edge {
  Point2 a, b;
  std::size_t region;
  double length_m() const { return length(b - a); }
  Point2 at(double t) const { return a + t * (b - a); }
  Bounds box() const { return bounds({a, b}); }
};

/// Records where the other edge crosses `edge`, as a share of its length from 0 to 1, and where the ends of the other
/// touch it.
void note_meetings(const Edge& edge, const Edge& other, std::vector<double>& cuts) {
  const double length = edge.length_m();
  const Point2 ahead{(edge.b.x - edge.a.x) / length, (edge.b.y - edge.a.y) / length};
  const auto along = [&](Point2 p) { return dot(p - edge.a, ahead); };
  const auto aside = [&](Point2 p) { return cross(ahead, p - edge.a); };
  const double left_a = aside(other.a), left_b = aside(other.b);
  const auto note = [&](double distance_m) {
    if (distance_m > touch_m && distance_m < length - touch_m) {
      cuts.push_back(distance_m / length);
    }
  };
  if (std::abs(left_a) < touch_m) note(along(other.a));
  if (std::abs(left_b) < touch_m) note(along(other.b));
  if ((left_a > 0) != (left_b > 0)) {
    note(along(other.at(left_a / (left_a - left_b))));
  }
}

/// The edges of all regions.
struct Edges {
  std::vector<Edge> all;
  BoundsTree tree;
};

Edges edges_of(const std::vector<GroundRegion>& regions) {
  std::vector<Edge> all;
  for (std::size_t own = 0; own < regions.size(); ++own) {
    const Polygon& outline = regions[own].outline;
    for (std::size_t i = 0; i < outline.size(); ++i)
      all.push_back({outline[i], outline[(i + 1) % outline.size()], own});
  }
  return {all, tree_of(all, [](const Edge& edge) { return edge.box(); })};
}

/// Where the edge must be cut so that each piece has one region on either side.
std::vector<double> cuts_of(const Edge& edge, const Edges& edges) {
  std::vector<double> cuts{0, 1};
  for (const std::size_t k : edges.tree.overlapping(widened(edge.box(), 2 * touch_m))) {
    if (edges.all[k].region != edge.region) note_meetings(edge, edges.all[k], cuts);
  }
  sort_cuts(cuts, edge.length_m());
  cuts.back() = 1;
  return cuts;
}

/// Appends the visible pieces of an edge, cut at these places; consecutive pieces with the same regions are joined.
void append_visible(const GroundPlan& plan, const Edge& edge, const std::vector<double>& cuts,
                    std::vector<Boundary>& out) {
  const double length = edge.length_m();
  const Point2 to_left{-(edge.b.y - edge.a.y) / length * aside_m, (edge.b.x - edge.a.x) / length * aside_m};
  bool goes_on = false;
  for (std::size_t i = 1; i < cuts.size(); ++i) {
    const Point2 middle = edge.at((cuts[i - 1] + cuts[i]) / 2);
    const int left = plan.region_at(middle + to_left);
    const int right = plan.region_at(middle - to_left);
    const bool visible = left != right && std::max(left, right) == static_cast<int>(edge.region);
    if (visible && goes_on && out.back().left == left && out.back().right == right) {
      out.back().to = edge.at(cuts[i]);
    } else if (visible) {
      out.push_back({edge.at(cuts[i - 1]), edge.at(cuts[i]), left, right});
    }
    goes_on = visible;
  }
}

}  // namespace

void sort_cuts(std::vector<double>& cuts, double length_m) {
  std::sort(cuts.begin(), cuts.end());
  const double near = touch_m / length_m;
  cuts.erase(std::unique(cuts.begin(), cuts.end(), [near](double a, double b) { return b - a < near; }), cuts.end());
}

// A visible piece between two regions lies on an edge of the later one: if it were only on an edge of the earlier one,
// the later one would cover both sides. So each piece is found once, at the edge of the upper of its two regions.
std::vector<Boundary> visible_boundaries(const std::vector<GroundRegion>& regions) {
  const GroundPlan plan(regions);
  const Edges edges = edges_of(regions);
  std::vector<Boundary> out;
  for (const Edge& edge : edges.all) append_visible(plan, edge, cuts_of(edge, edges), out);
  return out;
}

}  // namespace curbline::tools
