#include <cmath>
#include <limits>
#include <map>

#include "picture/texts.hpp"

namespace curbline::tools::picture {
namespace {

struct Middle {
  double x_m = 0, y_m = 0;  ///< sums until all cells have been added
  int cells = 0;
  double nearest_m = std::numeric_limits<double>::infinity();  ///< smallest distance of a cell to the middle
  Pixel at{};                                                  ///< position of that cell
};

template <typename Call>
void for_each_labelled(const Map& map, std::map<int, Middle>& middles, Call call) {
  for (int i = 0; i < map.grid.rows; ++i) {
    for (int j = 0; j < map.grid.cols; ++j) {
      const MapCell& cell = map.cells[map.grid.at(i, j)];
      if (cell.points > 0 && cell.label >= 0) call(middles[cell.label], map.grid.x_m(i), map.grid.y_m(j));
    }
  }
}

}  // namespace

std::vector<PlacedText> place_labels(const Map& map, const View& view, std::vector<Box> taken, const TextWidth& width) {
  std::map<int, Middle> middles;
  for_each_labelled(map, middles, [](Middle& middle, double x_m, double y_m) {
    middle.x_m += x_m;
    middle.y_m += y_m;
    ++middle.cells;
  });
  for_each_labelled(map, middles, [&](Middle& middle, double x_m, double y_m) {
    const double away_m = std::hypot(x_m - middle.x_m / middle.cells, y_m - middle.y_m / middle.cells);
    if (away_m >= middle.nearest_m) return;
    middle.nearest_m = away_m;
    middle.at = view.at(x_m, y_m);
  });
  const double cell_area = map.grid.dx_m * map.grid.dy_m * view.scale() * view.scale();
  std::vector<PlacedText> result;
  for (const auto& [label, middle] : middles) {
    const std::string words = std::to_string(label);
    const double text_width = width(words) + 4, height = text_height + 4;
    const Box box{middle.at.x - 0.5 * text_width, middle.at.y - 0.5 * height, text_width, height};
    if (middle.cells * cell_area < 2 * text_width * height || !is_free(box, view, taken, map.curbs)) continue;
    taken.push_back(box);
    result.push_back({words, box});
  }
  return result;
}

}  // namespace curbline::tools::picture
