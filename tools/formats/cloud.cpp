#include "formats/cloud.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "formats/ascii.hpp"
#include "formats/fields.hpp"
#include "formats/line_reader.hpp"
#include "formats/pcd.hpp"

namespace curbline::tools {
namespace {

static_assert(std::endian::native == std::endian::little, "KITTI clouds are little-endian");

/// The columns of x, y and z.
struct Columns {
  std::array<int, 3> of_axis{0, 1, 2};

  int last() const { return *std::max_element(of_axis.begin(), of_axis.end()); }
};

/// What a column's name refers to: "X", "y_m", "//z", "z_sd".
struct ColumnName {
  int axis = -1;               ///< 0 to 2; -1: none
  bool is_coordinate = false;  ///< "z" or "z [m]", not something of it, as "z_sd" may be
};

ColumnName parse_name(std::string_view name) {
  const auto is_alnum = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  const std::size_t start = std::min(name.find_first_not_of("/\""), name.size());
  std::string word = lower_case(std::string(name.substr(start)));
  if (word.empty() || word[0] < 'x' || word[0] > 'z' || (word.size() > 1 && is_alnum(word[1]))) return {};
  std::erase_if(word, [&](char c) { return !is_alnum(c); });
  return {word[0] - 'x', word.size() == 1 || word.substr(1) == "m"};
}

/// A first column without a name is that of an index.
bool is_header(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of(" \t/\","), line.size()));
  const auto is_alpha = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  const std::string word = lower_case(std::string(line.begin(), std::find_if_not(line.begin(), line.end(), is_alpha)));
  return !word.empty() && word != "nan" && word != "inf" && word != "infinity";
}

Columns read_header(const LineReader& source, Fields fields) {
  Columns columns{{-1, -1, -1}};
  std::array<bool, 3> is_coordinate{};
  std::array<int, 3> equals{};
  for (int column = 0; !fields.at_end(); ++column) {
    const ColumnName name = parse_name(fields.word("a column name"));
    if (name.axis < 0) continue;
    const auto axis = static_cast<std::size_t>(name.axis);
    if (equals[axis] > 0 && name.is_coordinate <= is_coordinate[axis]) {
      equals[axis] += name.is_coordinate == is_coordinate[axis];
      continue;
    }
    columns.of_axis[axis] = column;
    is_coordinate[axis] = name.is_coordinate;
    equals[axis] = 1;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (equals[axis] == 0)
      source.fail("no such columns; expected numbers, or names with x, y and z among them, apart by commas or blanks");
    if (equals[axis] > 1) source.fail(std::string("column ") + "xyz"[axis] + " twice; expected it once");
  }
  return columns;
}

bool is_finite(const Point3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

Point3 read_point(Fields& fields, const Columns& columns) {
  static constexpr std::array<std::string_view, 3> names{"x", "y", "z"};
  std::array<double, 3> value{};
  for (int column = 0; column <= columns.last(); ++column) {
    const auto axis = static_cast<std::size_t>(std::find(columns.of_axis.begin(), columns.of_axis.end(), column) -
                                               columns.of_axis.begin());
    if (axis < 3) {
      value[axis] = fields.number_or_nan(names[axis]);
    } else {
      fields.word("a column");
    }
  }
  return {value[0], value[1], value[2]};
}

std::vector<Point3> read_text(const std::string& path) {
  LineReader source(path);
  std::vector<Point3> points;
  Columns columns;
  bool first = true;
  while (const auto line = source.next()) {
    const auto apart = line->find(',') == std::string_view::npos ? Fields::Apart::blanks : Fields::Apart::commas;
    Fields fields(source, *line, apart);
    if (fields.at_end() || line->starts_with('#')) continue;
    if (first && is_header(*line)) {
      columns = read_header(source, fields);
    } else {
      points.push_back(read_point(fields, columns));
    }
    first = false;
  }
  return points;
}

std::vector<Point3> read_kitti(const std::string& path) {
  LineReader source(path);
  std::vector<Point3> points;
  std::array<float, 4> record{};
  std::size_t bytes = 0;
  while ((bytes = source.read_bytes(record.data(), sizeof record)) == sizeof record) {
    points.push_back({record[0], record[1], record[2]});
  }
  if (bytes == 0) return points;
  throw BadInput(path + ": " + std::to_string(points.size() * sizeof record + bytes) +
                 " bytes; expected a multiple of 16, float32 x y z intensity");
}

}  // namespace

std::vector<Point3> read_cloud(const std::string& path) {
  const std::string ending = lower_case(std::filesystem::path(path).extension().string());
  std::vector<Point3> points;
  if (ending == ".xyz" || ending == ".csv") {
    points = read_text(path);
  } else if (ending == ".pcd") {
    points = read_pcd(path);
  } else if (ending == ".bin") {
    points = read_kitti(path);
  } else {
    throw BadInput(path + ": unknown kind of cloud; expected a name that ends in .xyz, .csv, .pcd or .bin");
  }
  std::erase_if(points, [](const Point3& p) { return !is_finite(p); });
  if (points.empty()) throw BadInput(path + ": no points; expected at least one");
  return points;
}

}  // namespace curbline::tools
