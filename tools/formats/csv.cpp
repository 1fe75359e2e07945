#include "formats/csv.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "formats/decimals.hpp"
#include "formats/fields.hpp"
#include "formats/line_reader.hpp"

namespace curbline::tools {
namespace {

constexpr std::string_view label_columns = "x_m,y_m,height_m,variance_m2,points,label,probability";
constexpr std::string_view curb_columns = "x0_m,y0_m,x1_m,y1_m,height_m,height_sd_m,probability,kind";
constexpr int places = 6;
constexpr double furthest_m = 1e8;  ///< coordinates of a national grid are around 1e6
constexpr double longest_m = 1e4;   ///< of a curb: a longer one is a typing error, and takes long to score

void expect_header(LineReader& source, std::string_view columns) {
  const auto header = source.next();
  if (header != columns) source.fail("other columns; expected " + std::string(columns));
}

double read_place(Fields& fields, std::string_view name) {
  const double metres = fields.number(name);
  if (std::abs(metres) > furthest_m) fields.fail(name, readable(metres, 3), "metres in [-1e8, 1e8]");
  return metres;
}

/// A variance or a standard deviation.
double read_spread(Fields& fields, std::string_view name) {
  const double value = fields.number(name);
  if (!(value >= 0.0)) fields.fail(name, readable(value, places), "a number of 0 or more");
  return value;
}

double read_probability(Fields& fields) {
  const double value = fields.number("probability");
  if (!(value >= 0.0 && value <= 1.0)) fields.fail("probability", readable(value, places), "0 to 1");
  return value;
}

/// Reads the rows below the header, with one call of `read_row` each.
template <typename Row, typename ReadRow>
std::vector<Row> read_rows(const std::string& path, std::string_view columns, ReadRow read_row) {
  LineReader source(path);
  expect_header(source, columns);
  std::vector<Row> rows;
  while (const auto line = source.next()) {
    Fields fields(source, *line, Fields::Apart::commas);
    rows.push_back(read_row(fields));
    fields.expect_end();
  }
  return rows;
}

}  // namespace

std::vector<LabelledCell> labelled_cells(const Map& map) {
  std::vector<LabelledCell> out;
  for (int i = 0; i < map.grid.rows; ++i) {
    for (int j = 0; j < map.grid.cols; ++j) {
      const MapCell& cell = map.cells[map.grid.at(i, j)];
      if (cell.points > 0) out.push_back({map.grid.x_m(i), map.grid.y_m(j), cell});
    }
  }
  return out;
}

void write_labels(std::ostream& out, const Map& map) {
  std::string text = std::string(label_columns) + "\n";
  for (const auto& [x_m, y_m, cell] : labelled_cells(map)) {
    for (const double metres : {x_m, y_m, cell.height_m}) text += decimals(metres, places) + ",";
    text += decimals(cell.variance_m2, 9) + "," + std::to_string(cell.points) + "," + std::to_string(cell.label) + ",";
    text += decimals(cell.probability, places) + "\n";
  }
  out << text;
}

void write_curbs(std::ostream& out, const std::vector<MapCurb>& curbs) {
  std::string text = std::string(curb_columns) + "\n";
  for (const MapCurb& c : curbs) {
    for (const double value : {c.x0_m, c.y0_m, c.x1_m, c.y1_m, c.height_m, c.height_sd_m, c.probability}) {
      text += decimals(value, places) + ",";
    }
    text += c.kind + "\n";
  }
  out << text;
}

void write_curb_json(std::ostream& out, const MapCurb& c) {
  const auto rounded = [](double value) { return std::round(value * 1e6) / 1e6; };
  const nlohmann::ordered_json object = {
      {"x0_m", rounded(c.x0_m)},
      {"y0_m", rounded(c.y0_m)},
      {"x1_m", rounded(c.x1_m)},
      {"y1_m", rounded(c.y1_m)},
      {"position_sd_m", rounded(c.position_sd_m)},
      {"height_m", rounded(c.height_m)},
      {"height_sd_m", rounded(c.height_sd_m)},
      {"probability", rounded(c.probability)},
      {"kind", c.kind},
      {"face_width_m", rounded(c.face_width_m)},
      {"id", c.id},
  };
  out << object.dump() << '\n';
}

std::vector<LabelledCell> read_labels(const std::string& path) {
  return read_rows<LabelledCell>(path, label_columns, [](Fields& fields) {
    constexpr std::int64_t most = std::numeric_limits<int>::max();
    LabelledCell row;
    row.x_m = read_place(fields, "x_m");
    row.y_m = read_place(fields, "y_m");
    row.cell.height_m = fields.number("height_m");
    row.cell.variance_m2 = read_spread(fields, "variance_m2");
    row.cell.points = static_cast<int>(fields.whole("points", 1, most));
    row.cell.label = static_cast<int>(fields.whole("label", -1, most));
    row.cell.probability = read_probability(fields);
    return row;
  });
}

std::vector<MapCurb> read_curbs(const std::string& path) {
  return read_rows<MapCurb>(path, curb_columns, [](Fields& fields) {
    MapCurb curb;
    curb.x0_m = read_place(fields, "x0_m");
    curb.y0_m = read_place(fields, "y0_m");
    curb.x1_m = read_place(fields, "x1_m");
    curb.y1_m = read_place(fields, "y1_m");
    if (const double length_m = std::hypot(curb.x1_m - curb.x0_m, curb.y1_m - curb.y0_m); length_m > longest_m)
      fields.fail("the length", decimals(length_m, 3), "a piece of curb of 10 km at most");
    curb.height_m = fields.number("height_m");
    curb.height_sd_m = read_spread(fields, "height_sd_m");
    curb.probability = read_probability(fields);
    curb.kind = fields.word("kind");
    if (curb.kind != "step_up" && curb.kind != "step_down" && curb.kind != "crease" && curb.kind != "ramp_edge") {
      fields.fail("kind", curb.kind, "step_up, step_down, crease or ramp_edge");
    }
    return curb;
  });
}

}  // namespace curbline::tools
