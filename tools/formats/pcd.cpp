#include "formats/pcd.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>

#include "formats/fields.hpp"
#include "formats/line_reader.hpp"

namespace curbline::tools {
namespace {

static_assert(std::endian::native == std::endian::little, "binary PCD is little-endian");

constexpr std::int64_t most_fields = 1000;
constexpr std::int64_t most_points = std::int64_t{1} << 32;

struct Field {
  std::string name;
  std::int64_t size = 4;   ///< bytes
  std::int64_t count = 1;  ///< number of values
};

struct Header {
  std::vector<Field> fields;
  std::int64_t width = -1, height = -1, points = -1;
  bool binary = false;
};

/// The position of one coordinate within a point.
struct Place {
  std::int64_t column = 0;  ///< for ascii
  std::int64_t offset = 0;  ///< for binary, in bytes
  bool wide = false;        ///< float64
};

struct Layout {
  std::array<Place, 3> axes;
  std::int64_t columns = 0;
  std::int64_t bytes = 0;
};

bool is_axis(const std::string& name) {
  return name == "x" || name == "y" || name == "z";
}

void add_field(const LineReader& source, const std::string& name, Header& header) {
  const auto same = [&](const Field& field) { return field.name == name; };
  if (is_axis(name) && std::ranges::any_of(header.fields, same))
    source.fail("column " + name + " twice; expected it once");
  header.fields.push_back({.name = name});
}

void read_field_words(const LineReader& source, Fields& words, const std::string& key, Header& header) {
  if (key == "FIELDS") {
    while (!words.at_end()) {
      if (std::ssize(header.fields) == most_fields) words.fail(key, "more", "at most 1000 fields");
      add_field(source, std::string(words.word("a field name")), header);
    }
    return;
  }
  for (Field& field : header.fields) {
    const bool axis = is_axis(field.name);
    if (key == "SIZE") {
      field.size = words.whole(key, 1, 8);
      if (axis && field.size != 4 && field.size != 8)
        words.fail("SIZE of " + field.name, std::to_string(field.size), "4 or 8, a float");
    } else if (key == "COUNT") {
      field.count = words.whole(key, 1, 1'000'000);
      if (axis && field.count != 1) words.fail("COUNT of " + field.name, std::to_string(field.count), "1");
    } else {
      const std::string_view type = words.word(key);
      if (type != "I" && type != "U" && type != "F") words.fail(key, type, "I, U or F");
      if (axis && type != "F") words.fail("TYPE of " + field.name, type, "F");
    }
  }
}

void read_data_kind(Fields& words, Header& header) {
  const std::string_view kind = words.word("DATA");
  if (kind == "binary_compressed") {
    words.fail("DATA", kind, "ascii or binary; pcl_convert_pcd_ascii_binary writes either");
  }
  if (kind != "ascii" && kind != "binary") words.fail("DATA", kind, "ascii or binary");
  header.binary = kind == "binary";
}

/// Reads up to and including the DATA line. FIELDS must come before SIZE, TYPE and COUNT; VERSION, COUNT and VIEWPOINT
/// are optional.
Header read_header(LineReader& source) {
  Header header;
  while (const auto line = source.next()) {
    Fields words(source, *line);
    if (words.at_end() || line->starts_with('#')) continue;
    const std::string key(words.word("a key of the header"));
    if (key == "VERSION") {
      const std::string_view version = words.word(key);
      if (version != "0.7" && version != ".7") words.fail(key, version, "0.7");
    } else if (key == "FIELDS" || key == "SIZE" || key == "TYPE" || key == "COUNT") {
      read_field_words(source, words, key, header);
    } else if (key == "WIDTH") {
      header.width = words.whole(key, 0, most_points);
    } else if (key == "HEIGHT") {
      header.height = words.whole(key, 0, most_points);
    } else if (key == "POINTS") {
      header.points = words.whole(key, 0, most_points);
    } else if (key == "DATA") {
      read_data_kind(words, header);
      words.expect_end();
      return header;
    } else if (key == "VIEWPOINT") {
      while (!words.at_end()) words.number("VIEWPOINT");
    } else {
      words.fail("a key of the header", key,
                 "VERSION, FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, VIEWPOINT, POINTS or DATA");
    }
    words.expect_end();
  }
  throw BadInput(source.path() + ": the header has no DATA line; expected PCD 0.7");
}

Layout lay_out(const LineReader& source, const Header& header) {
  Layout layout;
  std::array<bool, 3> seen{};
  for (const Field& field : header.fields) {
    if (is_axis(field.name)) {
      const auto axis = static_cast<std::size_t>(field.name[0] - 'x');
      layout.axes[axis] = {layout.columns, layout.bytes, field.size == 8};
      seen[axis] = true;
    }
    layout.columns += field.count;
    layout.bytes += field.count * field.size;
  }
  if (!seen[0] || !seen[1] || !seen[2]) source.fail("the header lacks a field; expected x, y and z");
  if (layout.bytes > std::int64_t{1} << 20) source.fail("a point is too long; expected at most 1 MiB");
  if (header.width < 0 || header.height < 0) source.fail("the header lacks WIDTH or HEIGHT; expected both");
  if (header.height > 0 && header.width > most_points / header.height) {
    source.fail("WIDTH x HEIGHT is too large; expected at most 2^32 points");
  }
  if (header.points >= 0 && header.points != header.width * header.height) {
    source.fail("POINTS is " + std::to_string(header.points) + "; expected WIDTH x HEIGHT, " +
                std::to_string(header.width * header.height));
  }
  return layout;
}

double number_at(const std::vector<char>& record, const Place& place) {
  const char* const from = record.data() + place.offset;
  if (place.wide) {
    double value = 0.0;
    std::memcpy(&value, from, sizeof value);
    return value;
  }
  float value = 0.0f;
  std::memcpy(&value, from, sizeof value);
  return static_cast<double>(value);
}

/// x, y, z of the next point; nothing if the file ends before it.
std::optional<std::array<double, 3>> read_binary_point(LineReader& source, const Layout& layout,
                                                       std::vector<char>& record) {
  if (source.read_bytes(record.data(), record.size()) < record.size()) return std::nullopt;
  return std::array{number_at(record, layout.axes[0]), number_at(record, layout.axes[1]),
                    number_at(record, layout.axes[2])};
}

std::optional<std::array<double, 3>> read_ascii_point(LineReader& source, const Layout& layout) {
  static constexpr std::array<std::string_view, 3> names{"x", "y", "z"};
  while (const auto line = source.next()) {
    Fields fields(source, *line);
    if (fields.at_end()) continue;
    std::array<double, 3> xyz{};
    for (std::int64_t column = 0; column < layout.columns; ++column) {
      std::size_t axis = 0;
      while (axis < 3 && layout.axes[axis].column != column) ++axis;
      if (axis < 3) {
        xyz[axis] = fields.number_or_nan(names[axis]);
      } else {
        fields.word("a field");
      }
    }
    fields.expect_end();
    return xyz;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Point3> read_pcd(const std::string& path) {
  LineReader source(path);
  const Header header = read_header(source);
  const Layout layout = lay_out(source, header);
  const std::int64_t promised = header.width * header.height;
  std::vector<char> record(static_cast<std::size_t>(layout.bytes));
  std::vector<Point3> points;
  const auto next_point = [&] {
    return header.binary ? read_binary_point(source, layout, record) : read_ascii_point(source, layout);
  };
  for (std::int64_t i = 0; i < promised; ++i) {
    const auto xyz = next_point();
    if (!xyz) {
      throw BadInput(path + ": the file ends after " + std::to_string(i) + " points; expected " +
                     std::to_string(promised));
    }
    const auto [x, y, z] = *xyz;
    points.push_back({x, y, z});
  }
  if (next_point()) {
    const std::string what = "more points; expected " + std::to_string(promised) + " as the header has it";
    if (header.binary) throw BadInput(path + ": " + what);
    source.fail(what);
  }
  return points;
}

}  // namespace curbline::tools
