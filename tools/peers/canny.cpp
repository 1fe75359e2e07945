#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "peers/peers.hpp"
#include "peers/polynomials.hpp"

namespace curbline::tools::peers {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Metres per cell: a smoothed step of h peaks at about 0.4 h; the weak threshold is a slope of 8 % over cells of 10
/// cm.
constexpr double strong = 0.4 * least_step_m, weak = 0.008;
constexpr int reach = 2;  ///< cells to either side of an edge that are used for the height of the step

/// Heights by cell, NaN if unknown.
class Image {
 public:
  Image(int rows, int cols)
      : rows_(rows), cols_(cols), at_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols), nan) {}
  int rows() const { return rows_; }
  int cols() const { return cols_; }
  double operator()(int i, int j) const { return inside(i, j) ? at_[index(i, j)] : nan; }
  double& at(int i, int j) { return at_[index(i, j)]; }

 private:
  bool inside(int i, int j) const { return i >= 0 && j >= 0 && i < rows_ && j < cols_; }
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(j);
  }
  int rows_, cols_;
  std::vector<double> at_;
};

template <typename Value>
Image made(int rows, int cols, Value value) {
  Image out(rows, cols);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < cols; ++j) out.at(i, j) = value(i, j);
  }
  return out;
}

/// Heights, with holes of one cell, such as gaps between scan lines, filled from two neighbours or more.
Image heights_of(const reference::Dem& dem) {
  const Grid& g = dem.grid;
  const Image raw = made(g.rows, g.cols, [&](int i, int j) {
    const reference::DemCell& cell = dem.cells[g.at(i, j)];
    return cell.points > 0 ? cell.height_m : nan;
  });
  return made(g.rows, g.cols, [&](int i, int j) {
    if (!std::isnan(raw(i, j))) return raw(i, j);
    double sum = 0;
    int n = 0;
    for (const double z : {raw(i - 1, j), raw(i + 1, j), raw(i, j - 1), raw(i, j + 1)}) {
      if (!std::isnan(z)) sum += z, ++n;
    }
    return n >= 2 ? sum / n : nan;
  });
}

/// Weighted sum over the 3 x 3 cells around a cell, weights by row and column; NaN beside a hole.
double filtered(const Image& image, int i, int j, const std::array<double, 3>& along_i,
                const std::array<double, 3>& along_j) {
  double sum = 0;
  for (int di = -1; di <= 1; ++di) {
    for (int dj = -1; dj <= 1; ++dj) {
      sum +=
          along_i[static_cast<std::size_t>(di + 1)] * along_j[static_cast<std::size_t>(dj + 1)] * image(i + di, j + dj);
    }
  }
  return sum;
}

struct Gradient {
  Image along_i, along_j, size;
};

Gradient gradient_of(const Image& heights) {
  constexpr std::array<double, 3> smooth{0.25, 0.5, 0.25}, difference{-0.5, 0, 0.5};
  const int rows = heights.rows(), cols = heights.cols();
  Gradient out{made(rows, cols, [&](int i, int j) { return filtered(heights, i, j, difference, smooth); }),
               made(rows, cols, [&](int i, int j) { return filtered(heights, i, j, smooth, difference); }),
               Image(rows, cols)};
  out.size = made(rows, cols, [&](int i, int j) { return std::hypot(out.along_i(i, j), out.along_j(i, j)); });
  return out;
}

/// The maximum of the gradient along its own direction, interpolated between cells by a parabola; the offset is in
/// cells.
std::optional<double> ridge(const Gradient& g, int i, int j) {
  const double size = g.size(i, j);
  if (!(size >= weak)) return std::nullopt;
  const int di = static_cast<int>(std::lround(g.along_i(i, j) / size)),
            dj = static_cast<int>(std::lround(g.along_j(i, j) / size));
  const auto or_zero = [](double value) { return std::isnan(value) ? 0.0 : value; };
  const double before = or_zero(g.size(i - di, j - dj)), after = or_zero(g.size(i + di, j + dj));
  if (before > size || after >= size) return std::nullopt;
  const double bend = before - 2 * size + after;
  return bend < 0 ? 0.5 * (before - after) / bend * std::hypot(di, dj) : 0;
}

/// The known height on one side of the edge, along the gradient: as far from the edge as possible, so that it is that
/// of the level ground.
double side_height(const Image& heights, double i, double j, double ui, double uj) {
  for (int far = reach; far >= 1; --far) {
    const double z = heights(static_cast<int>(std::lround(i + far * ui)), static_cast<int>(std::lround(j + far * uj)));
    if (!std::isnan(z)) return z;
  }
  return nan;
}

using CellIndex = std::pair<int, int>;  ///< row and column

/// Adds a cell and all ridges connected with it through neighbours.
void join_ridges(const Image& ridges, CellIndex from, Image& kept, std::vector<CellIndex>& out) {
  const auto keep = [&](int i, int j) {
    kept.at(i, j) = 1;
    out.push_back({i, j});
  };
  std::size_t next = out.size();
  for (keep(from.first, from.second); next < out.size(); ++next) {
    const auto [row, col] = out[next];
    for (int i = row - 1; i <= row + 1; ++i) {
      for (int j = col - 1; j <= col + 1; ++j) {
        if (!std::isnan(ridges(i, j)) && std::isnan(kept(i, j))) keep(i, j);
      }
    }
  }
}

/// Edges above the weak threshold that are connected with a strong one through neighbours (Canny's hysteresis).
std::vector<CellIndex> joined_to_strong(const Image& ridges, const Gradient& g) {
  Image kept(ridges.rows(), ridges.cols());
  std::vector<CellIndex> out;
  for (int i = 0; i < ridges.rows(); ++i) {
    for (int j = 0; j < ridges.cols(); ++j) {
      const bool is_strong = !std::isnan(ridges(i, j)) && g.size(i, j) >= strong;
      if (is_strong && std::isnan(kept(i, j))) join_ridges(ridges, {i, j}, kept, out);
    }
  }
  return out;
}

}  // namespace

std::vector<MapCurb> canny_curbs(const reference::Dem& dem) {
  const Grid& grid = dem.grid;
  const Image heights = heights_of(dem);
  const Gradient g = gradient_of(heights);
  const Image ridges = made(grid.rows, grid.cols, [&](int i, int j) { return ridge(g, i, j).value_or(nan); });
  std::vector<EdgePoint> edges;
  for (const auto& [i, j] : joined_to_strong(ridges, g)) {
    const double ui = g.along_i(i, j) / g.size(i, j), uj = g.along_j(i, j) / g.size(i, j);
    const double at_i = i + ridges(i, j) * ui, at_j = j + ridges(i, j) * uj;
    const double step = side_height(heights, at_i, at_j, ui, uj) - side_height(heights, at_i, at_j, -ui, -uj);
    if (!(step >= least_step_m && step <= most_step_m)) continue;
    EdgePoint edge{grid.x0_m + (at_i + 0.5) * grid.dx_m, grid.y0_m + (at_j + 0.5) * grid.dy_m, 0};
    // Whether the gradient points away from the origin.
    const bool up = edge.x_m * ui * grid.dx_m + edge.y_m * uj * grid.dy_m > 0;
    edge.height_m = up ? step : -step;
    edges.push_back(edge);
  }
  return polynomial_curbs(edges);
}

}  // namespace curbline::tools::peers
