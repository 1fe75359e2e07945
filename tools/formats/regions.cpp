#include "formats/regions.hpp"

#include "formats/decimals.hpp"
#include "formats/fields.hpp"
#include "formats/line_reader.hpp"

namespace curbline::tools {

std::vector<Polygon> read_regions(const std::string& path) {
  LineReader source(path);
  std::vector<Polygon> regions;
  Polygon region;
  const auto finish = [&] {
    if (region.empty()) return;
    if (region.size() < 3) {
      source.fail("the polygon ends after " + std::to_string(region.size()) + " corners; expected at least 3");
    }
    regions.push_back(std::move(region));
    region.clear();
  };
  while (const auto line = source.next()) {
    Fields fields(source, *line);
    if (fields.at_end()) {
      finish();
      continue;
    }
    const double x_mm = fields.number("x");
    const double y_mm = fields.number("y");
    fields.expect_end();
    region.push_back({x_mm / 1000.0, y_mm / 1000.0});
  }
  finish();
  if (regions.empty()) throw BadInput(path + ": no region; expected a polygon of x y in millimetres");
  return regions;
}

void write_regions(std::ostream& out, const std::vector<Polygon>& regions) {
  std::string text;
  for (const Polygon& region : regions) {
    for (const Point2 corner : region) {
      text += decimals(corner.x * 1000.0, 1) + " " + decimals(corner.y * 1000.0, 1) + "\n";
    }
    text += "\n";
  }
  out << text;
}

}  // namespace curbline::tools
