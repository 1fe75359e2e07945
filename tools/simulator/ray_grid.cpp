// The ray caster's preparation: faces, prisms and the grid that lists the contents of each cell.
#include "simulator/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace curbline::tools {
namespace {

constexpr double most_cells_a_side = 400;
constexpr double buried_m = 1;  // depth of obstacles in the ground, so that no gap opens on a slope or beside a curb

bool any_edge_crosses(const Polygon& outline, const Bounds& box) {
  for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
    if (crosses(box, outline[j], outline[i])) {
      return true;
    }
  }
  return false;
}

}  // namespace

/// What lies on the plan, for the cells.
struct RayCaster::Contents {
  const GroundPlan& plan;
  BoundsTree faces, obstacles;
};

RayCaster::RayCaster(const Scene& scene) : regions_(scene.regions) {
  const GroundPlan plan(regions_);
  for (const Boundary& piece : visible_boundaries(regions_)) {
    if (piece.left >= 0 && piece.right >= 0) {
      faces_.push_back({piece.from, piece.to, regions_[static_cast<std::size_t>(piece.left)].plane,
                        regions_[static_cast<std::size_t>(piece.right)].plane});
    }
  }
  for (const Obstacle& obstacle : scene.obstacles) {
    if (obstacle.moves()) {
      moving_.push_back(obstacle);
      moved_.push_back(prism_of(obstacle, plan));
    } else {
      fixed_.push_back(prism_of(obstacle, plan));
    }
  }
  lay_grid(plan);
  move_to(0);
}

RayCaster::Prism RayCaster::prism_of(const Obstacle& obstacle, const GroundPlan& plan) const {
  Prism prism;
  prism.outline = obstacle.outline;
  for (const Point2 p : obstacle.outline) {
    prism.centre.x += p.x / static_cast<double>(obstacle.outline.size());
    prism.centre.y += p.y / static_cast<double>(obstacle.outline.size());
  }
  for (const Point2 p : obstacle.outline) {
    prism.radius_m = std::max(prism.radius_m, length(p - prism.centre));
  }
  const int region = obstacle.base_m ? -1 : plan.region_at(prism.centre);
  const double base = region < 0 ? 0 : regions_[static_cast<std::size_t>(region)].plane.height_m(prism.centre);
  prism.bottom_m = obstacle.base_m ? *obstacle.base_m : base - buried_m;
  prism.top_m = obstacle.base_m.value_or(base) + obstacle.height_m;
  return prism;
}

void RayCaster::move_to(double time_s) {
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    Prism& prism = moved_[i];
    prism.offset = time_s * moving_[i].velocity_m_s;
    const double ground = ground_height_m(prism.centre + prism.offset);
    if (!moving_[i].base_m && std::isfinite(ground)) {
      prism.bottom_m = ground - buried_m;
      prism.top_m = ground + moving_[i].height_m;
    }
  }
}

void RayCaster::lay_grid(const GroundPlan& plan) {
  bool first = true;
  const auto take_in = [&](const Bounds& box) {
    bounds_ = first ? box : united(bounds_, box);
    first = false;
  };
  for (const GroundRegion& region : regions_) {
    if (!region.outline.empty()) take_in(bounds(region.outline));
  }
  for (const Prism& prism : fixed_) take_in(bounds(prism.outline));
  const double longest = std::max(bounds_.x1 - bounds_.x0, bounds_.y1 - bounds_.y0);
  cell_m_ = std::max(0.5, longest / most_cells_a_side);
  rows_ = static_cast<int>((bounds_.x1 - bounds_.x0) / cell_m_) + 1;
  cols_ = static_cast<int>((bounds_.y1 - bounds_.y0) / cell_m_) + 1;
  bounds_.x1 = bounds_.x0 + rows_ * cell_m_;
  bounds_.y1 = bounds_.y0 + cols_ * cell_m_;

  top_m_ = -nothing;
  for (const GroundRegion& region : regions_) {
    const Bounds box = region.outline.empty() ? bounds_ : bounds(region.outline);
    const bool bulges = region.plane.camber.bend_1_m > 0;  // camber only lowers it
    for (const Point2 p : rectangle({box.x0, box.y0}, {box.x1, box.y1})) {
      top_m_ = std::max(top_m_, bulges ? region.plane.level_m(p) : region.plane.height_m(p));
    }
  }
  for (const Prism& prism : fixed_) top_m_ = std::max(top_m_, prism.top_m);

  const auto about_face = [](const Face& face) { return bounds({face.from, face.to}); };
  const auto about_prism = [](const Prism& prism) { return bounds(prism.outline); };
  const Contents contents{plan, tree_of(faces_, about_face), tree_of(fixed_, about_prism)};
  cells_.resize(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(cols_));
  for (int i = 0; i < rows_; ++i) {
    for (int j = 0; j < cols_; ++j) {
      const double x = bounds_.x0 + i * cell_m_, y = bounds_.y0 + j * cell_m_;
      fill_cell(cells_[static_cast<std::size_t>(i * cols_ + j)], {x, y, x + cell_m_, y + cell_m_}, contents);
    }
  }
}

void RayCaster::fill_cell(Cell& cell, const Bounds& box, const Contents& contents) {
  cell.first = static_cast<std::uint32_t>(items_.size());
  const Point2 middle{(box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2};
  for (const std::size_t k : contents.plan.near(box)) {
    const Polygon& outline = regions_[k].outline;
    const bool cut = !outline.empty() && any_edge_crosses(outline, box);
    const bool covered = !cut && regions_[k].holds(middle);
    if (cut || covered) {
      items_.push_back(static_cast<std::uint32_t>(k));
      ++cell.regions;
    }
    if (covered) {
      cell.plain = cell.regions == 1;
      break;
    }
  }
  for (const std::size_t k : contents.faces.overlapping(widened(box, touch_m))) {
    if (crosses(box, faces_[k].from, faces_[k].to)) {
      items_.push_back(static_cast<std::uint32_t>(k));
      ++cell.faces;
    }
  }
  for (const std::size_t k : contents.obstacles.overlapping(box)) {
    items_.push_back(static_cast<std::uint32_t>(k));
    ++cell.obstacles;
  }
}

}  // namespace curbline::tools
