#include "simulator/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace curbline::tools {
namespace {

constexpr double slack = 1e-9;  // in a ray's parameter, at the border of two cells

}  // namespace

const RayCaster::Cell* RayCaster::cell_at(Point2 p) const {
  const int i = static_cast<int>(std::floor((p.x - bounds_.x0) / cell_m_));
  const int j = static_cast<int>(std::floor((p.y - bounds_.y0) / cell_m_));
  return i < 0 || i >= rows_ || j < 0 || j >= cols_ ? nullptr : &cells_[static_cast<std::size_t>(i * cols_ + j)];
}

int RayCaster::region_in(const Cell& cell, Point2 p) const {
  for (std::uint32_t k = cell.first; k < cell.first + cell.regions; ++k) {
    if (cell.plain || regions_[items_[k]].holds(p)) {
      return static_cast<int>(items_[k]);
    }
  }
  return -1;
}

double RayCaster::ground_height_m(Point2 p) const {
  const Cell* cell = cell_at(p);
  const int outside = regions_.front().outline.empty() ? 0 : -1;
  const int region = cell == nullptr ? outside : region_in(*cell, p);
  return region < 0 ? -nothing : regions_[static_cast<std::size_t>(region)].plane.height_m(p);
}

double RayCaster::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  const Ray ray{origin, direction};
  double best = nothing;
  for (const Prism& prism : moved_) {
    best = std::min(best, hit_prism(ray, prism));
  }
  const Share grid = over_grid(ray);
  best = std::min(best, cast_outside(ray, grid));
  return cast_inside(ray, grid, best);
}

/// The part of the ray above the grid.
Share RayCaster::over_grid(const Ray& ray) const {
  Share over{0, nothing};
  over.clip(ray.origin.x(), ray.direction.x(), bounds_.x0, bounds_.x1);
  over.clip(ray.origin.y(), ray.direction.y(), bounds_.y0, bounds_.y1);
  return over;
}

/// Outside the grid there is only the unbounded ground, or nothing.
double RayCaster::cast_outside(const Ray& ray, const Share& grid) const {
  if (!regions_.front().outline.empty()) {
    return nothing;
  }
  const double t = hit_plane(ray, regions_.front().plane);
  return t > grid.from && t < grid.to ? nothing : t;
}

/// Amanatides and Woo's traversal of the cells under the ray.
double RayCaster::cast_inside(const Ray& ray, const Share& grid, double best) const {
  if (!grid.any()) {
    return best;
  }
  const double dx = ray.direction.x(), dy = ray.direction.y();
  const Point2 start = ray.at(grid.from);
  int row = std::clamp(static_cast<int>((start.x - bounds_.x0) / cell_m_), 0, rows_ - 1);
  int col = std::clamp(static_cast<int>((start.y - bounds_.y0) / cell_m_), 0, cols_ - 1);
  const int row_step = dx > 0 ? 1 : -1, col_step = dy > 0 ? 1 : -1;
  double t = grid.from;
  while (row >= 0 && row < rows_ && col >= 0 && col < cols_ && t < best) {
    if (ray.direction.z() >= 0 && ray.z(t) > top_m_) {
      break;
    }
    const double row_end = bounds_.x0 + (dx > 0 ? row + 1 : row) * cell_m_;
    const double col_end = bounds_.y0 + (dy > 0 ? col + 1 : col) * cell_m_;
    const double next_row = dx == 0 ? nothing : (row_end - ray.origin.x()) / dx;
    const double next_col = dy == 0 ? nothing : (col_end - ray.origin.y()) / dy;
    const double to = std::min(next_row, next_col);
    best = std::min(best, cast_in_cell(ray, cells_[static_cast<std::size_t>(row * cols_ + col)], t, to));
    t = to;
    (next_row < next_col ? row : col) += next_row < next_col ? row_step : col_step;
  }
  return best;
}

/// Planes count only while the ray is above the cell; a face or an obstacle counts wherever it is hit.
double RayCaster::cast_in_cell(const Ray& ray, const Cell& cell, double from, double to) const {
  double best = nothing;
  const std::uint32_t* item = items_.data() + cell.first;
  for (std::uint32_t k = 0; k < cell.regions; ++k, ++item) {
    const double t = hit_plane(ray, regions_[*item].plane);
    if (t >= from - slack && t <= to + slack && t < best &&
        (cell.plain || region_in(cell, ray.at(t)) == static_cast<int>(*item))) {
      best = t;
    }
  }
  for (std::uint32_t k = 0; k < cell.faces; ++k, ++item) best = std::min(best, hit_face(ray, faces_[*item]));
  for (std::uint32_t k = 0; k < cell.obstacles; ++k, ++item) best = std::min(best, hit_prism(ray, fixed_[*item]));
  return best;
}

double RayCaster::hit_plane(const Ray& ray, const SurfacePlane& plane) {
  const Point2 from{ray.origin.x(), ray.origin.y()}, slope = plane.slope(from);
  const double above = ray.origin.z() - plane.height_m(from);
  const double fall = slope.x * ray.direction.x() + slope.y * ray.direction.y() - ray.direction.z();
  if (plane.camber.bend_1_m == 0) {
    const double t = above / fall;
    return t > 0 ? t : nothing;
  }
  // The smallest positive t at which above - fall t + bend t^2 is 0.
  const double aside = plane.camber.across.x * ray.direction.x() + plane.camber.across.y * ray.direction.y();
  const double bend = 0.5 * plane.camber.bend_1_m * aside * aside, rest = fall * fall - 4 * bend * above;
  if (!(rest >= 0)) return nothing;
  const double sum = fall + std::copysign(std::sqrt(rest), fall);  // avoids subtracting numbers of similar size
  const double one = 2 * above / sum, other = sum / (2 * bend);
  return std::min(one > 0 ? one : nothing, other > 0 ? other : nothing);
}

double RayCaster::hit_face(const Ray& ray, const Face& face) {
  const double ex = face.to.x - face.from.x, ey = face.to.y - face.from.y;
  const double turn = ray.direction.x() * ey - ray.direction.y() * ex;
  const double wx = face.from.x - ray.origin.x(), wy = face.from.y - ray.origin.y();
  const double t = (wx * ey - wy * ex) / turn;
  const double along = (wx * ray.direction.y() - wy * ray.direction.x()) / turn;
  if (!(t > 0 && t < nothing && along >= 0 && along <= 1)) {
    return nothing;
  }
  const double z = ray.z(t), left = face.left.height_m(ray.at(t)), right = face.right.height_m(ray.at(t));
  return z >= std::min(left, right) && z <= std::max(left, right) ? t : nothing;
}

/// Cyrus and Beck: each side in turn clips the ray.
double RayCaster::hit_prism(const Ray& ray, const Prism& prism) {
  const double ox = ray.origin.x() - prism.offset.x, oy = ray.origin.y() - prism.offset.y;
  const double dx = ray.direction.x(), dy = ray.direction.y();
  const double aside = (prism.centre.x - ox) * dy - (prism.centre.y - oy) * dx;
  if (aside * aside > prism.radius_m * prism.radius_m * (dx * dx + dy * dy)) {
    return nothing;
  }
  double from = 0, to = nothing;
  const auto cut = [&](double outside, double rate) {  // inside while outside + rate t <= 0
    if (rate == 0) {
      if (outside > 0) to = -1;
    } else if (rate < 0) {
      from = std::max(from, -outside / rate);
    } else {
      to = std::min(to, -outside / rate);
    }
  };
  cut(ray.origin.z() - prism.top_m, ray.direction.z());
  cut(prism.bottom_m - ray.origin.z(), -ray.direction.z());
  for (std::size_t i = 0, j = prism.outline.size() - 1; i < prism.outline.size() && from <= to; j = i++) {
    const Point2 a = prism.outline[j], b = prism.outline[i];
    const double nx = b.y - a.y, ny = a.x - b.x;
    cut((ox - a.x) * nx + (oy - a.y) * ny, dx * nx + dy * ny);
  }
  return from <= to && from > 0 ? from : nothing;
}

}  // namespace curbline::tools
