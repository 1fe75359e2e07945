#include "picture/picture.hpp"

#include <cmath>
#include <cstring>
#include <numbers>

#include "formats_support.hpp"
#include "picture/page.hpp"
#include "picture/texts.hpp"
#include "picture/ticks.hpp"

using namespace curbline::tools;
using namespace curbline::tools::testing;
using namespace curbline::tools::picture;

namespace fs = std::filesystem;

namespace {

Map window(int rows, int cols) {
  Map map;
  map.grid = {0, -0.05 * cols, 0.1, 0.1, rows, cols};
  map.cells.resize(map.grid.cells());
  return map;
}

/// A road with label 0 and, from y = 1 m to the left, a pavement with label 1 that is 12 cm higher:
///
///   z        ______ 1
///     0 ____|
///             --> y
Map street() {
  Map map = window(40, 40);
  for (int i = 0; i < map.grid.rows; ++i) {
    for (int j = 0; j < map.grid.cols; ++j) {
      const bool pavement = map.grid.y_m(j) > 1;
      map.cells[map.grid.at(i, j)] = {map.grid.x_m(i), map.grid.y_m(j), pavement ? 0.12 : 0.0, 1e-4, 5, pavement, 1};
    }
  }
  map.curbs.push_back({0, 1, 4, 1, 0.12, 0.002, 0.99, "step_up"});
  return map;
}

std::string drawn(const Map& map, const std::string& name, const PictureExtras& extras = {}) {
  const TemporaryDirectory dir;
  draw_picture(map, dir.path(name), extras);
  return read_file(dir.path(name));
}

/// The text between <desc> and </desc>, which states the heights drawn.
std::string described(const Map& map) {
  const std::string svg = drawn(map, "a.svg");
  const std::size_t from = svg.find("<desc>") + 6;
  return svg.substr(from, svg.find("</desc>") - from);
}

struct Size {
  unsigned width, height;
};

Size size_of_png(const std::string& png) {
  REQUIRE(png.size() > 24);
  const auto number = [&](std::size_t at) {
    unsigned value = 0;
    for (std::size_t n = 0; n < 4; ++n) value = value << 8 | static_cast<unsigned char>(png[at + n]);
    return value;
  };
  return {number(16), number(20)};
}

bool same(const Colour& a, const Colour& b) {
  return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b) < 0.02;
}

/// A picture, written and read back.
class Seen {
 public:
  Seen(const Map& map, const PictureExtras& extras = {}) : page(lay_out(map, extras)) {
    const TemporaryDirectory dir;
    draw_picture(map, dir.path("a.png"), extras);
    surface_.reset(cairo_image_surface_create_from_png(dir.path("a.png").c_str()));
  }
  Colour at(const Pixel& pixel) const {
    const unsigned char* row = cairo_image_surface_get_data(surface_.get()) +
                               static_cast<int>(pixel.y) * cairo_image_surface_get_stride(surface_.get());
    std::uint32_t value = 0;
    std::memcpy(&value, row + 4 * static_cast<int>(pixel.x), sizeof value);
    return {(value >> 16 & 255) / 255.0, (value >> 8 & 255) / 255.0, (value & 255) / 255.0};
  }
  const Page page;

 private:
  Surface surface_;
};

double seven_pixels_a_letter(const std::string& words) {
  return 7.0 * static_cast<double>(words.size());
}

/// 400 x 400 pixels for 4 x 4 m, y from -2 m.
const View view{0, 4, -2, 2, {0, 0, 400, 400}};

std::vector<std::string> words_of(const std::vector<PlacedText>& texts) {
  std::vector<std::string> words;
  for (const PlacedText& text : texts) words.push_back(text.words);
  return words;
}

using Words = std::vector<std::string>;

}  // namespace

TEST_CASE("picture: another ending than .png or .svg is refused, and the two are named") {
  const TemporaryDirectory dir;
  for (const char* name : {"a.jpg", "a", "png", "a.png.txt"}) {
    CHECK(error_of([&] { draw_picture(street(), dir.path(name)); }) ==
          std::string(name) + ": cannot tell the kind of picture; expected a name that ends in .png or .svg");
  }
  CHECK(fs::is_empty(dir.path("")));
}

TEST_CASE("picture: endings may be in capitals") {
  CHECK(drawn(street(), "a.PNG").starts_with("\x89PNG"));
  CHECK(drawn(street(), "a.Svg").starts_with("<?xml"));
}

TEST_CASE("picture: a PNG of any window stays within 1600 x 1000 pixels") {
  for (const auto& [rows, cols] : {std::pair{40, 40}, {200, 100}, {512, 512}, {512, 40}, {40, 512}, {4, 4}, {1, 512}}) {
    const std::string png = drawn(window(rows, cols), "a.png", {.title = "a window"});
    CHECK(png.starts_with("\x89PNG\r\n\x1a\n"));
    CAPTURE(rows, cols);
    CHECK(size_of_png(png).width <= 1600);
    CHECK(size_of_png(png).width >= 600);
    CHECK(size_of_png(png).height <= 1000);
    CHECK(size_of_png(png).height >= 200);
  }
}

TEST_CASE("picture: all parts lie on the page and none on another") {
  for (const auto& [rows, cols] : {std::pair{40, 40}, {200, 100}, {512, 512}, {512, 40}, {40, 512}, {1, 512}}) {
    Map map = window(rows, cols);
    map.cells[0].points = 1;
    const Page page = lay_out(map, {.title = "a window"});
    const Box whole{0, 0, page.width, page.height};
    const Box parts[] = {page.heights.box, page.planes.box, page.bar, page.legend};
    for (const Box& part : parts) {
      CHECK(inside(part, whole));
      for (const Box& other : parts) CHECK((&part == &other || !overlap(part, other)));
    }
  }
}

TEST_CASE("picture: in a wide window the panels lie one below the other and fill the page's width") {
  const Page wide = lay_out(window(40, 512), {}), square = lay_out(window(40, 40), {});
  CHECK(wide.heights.box.width > 1000);
  CHECK(wide.planes.box.x == wide.heights.box.x);
  CHECK(wide.planes.box.y > wide.heights.box.bottom() + bottom_room);
  CHECK(square.planes.box.y == square.heights.box.y);
}

TEST_CASE("picture: in either layout a curb's height stands on both panels") {
  for (const int cols : {40, 400}) {
    Map map = window(40, cols);
    for (MapCell& cell : map.cells) cell = {0, 0, 0, 1e-4, 1, 0, 1};
    const double middle = map.grid.y0_m + 0.05 * cols;
    map.curbs = {{2, middle - 1.9, 2, middle + 1.9, 0.12, 0.01, 1, "step_up"}};
    const Seen with(map);
    map.curbs[0].height_m = 0.001;  // too low for a text
    const Seen without(map);
    for (const View* panel : {&with.page.heights, &with.page.planes}) {
      int differ = 0;
      for (double u = 0; u < panel->box.width; ++u) {
        for (double v = 0; v < panel->box.height; ++v) {
          const Pixel at{panel->box.x + u, panel->box.y + v};
          differ += !same(with.at(at), without.at(at));
        }
      }
      CHECK(differ > 50);
    }
  }
}

TEST_CASE("picture: beside a panel there is room for its numbers and the axis's name, in windows of any size") {
  const Surface scratch(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1));
  const Context cr(cairo_create(scratch.get()));
  set_font(cr.get(), text_height);
  for (const double metres : {0.02, 0.4, 1.0, 4.0, 51.2}) {
    const View window{0, metres, -metres / 2, metres / 2, {0, 0, 500, 500}};
    const double room_px = left_room(cr.get(), window) - 1.5 * text_height;  // the name, upright
    CAPTURE(metres);
    for (const Tick& tick : ticks(0, metres, 500 / metres, [](const std::string&) { return 1.6 * text_height; })) {
      CHECK(text_width(cr.get(), tick.words) + 5 < room_px);
    }
  }
}

TEST_CASE("picture: x ahead points up and y left points left") {
  Map map = window(40, 40);
  map.cells[map.grid.at(39, 39)] = {3.95, 1.95, 0.5, 1e-4, 5, 3, 1};  // ahead, to the left
  const Seen seen(map);
  for (const View* panel : {&seen.page.heights, &seen.page.planes}) {
    const Box& box = panel->box;
    CHECK_FALSE(same(seen.at({box.x + 5, box.y + 5}), no_data));
    CHECK(same(seen.at({box.right() - 6, box.y + 5}), no_data));
    CHECK(same(seen.at({box.x + 5, box.bottom() - 6}), no_data));
    CHECK(panel->at(4, 2).x == Approx(box.x));
    CHECK(panel->at(4, 2).y == Approx(box.y));
  }
  CHECK(same(seen.at(seen.page.planes.at(3.95, 1.95)), plane_colour(0)));
}

TEST_CASE("picture: cells have the colours of their planes, and a cell without one is not one without data") {
  Map map = street();
  map.cells[map.grid.at(20, 10)].label = -1;
  map.cells[map.grid.at(20, 5)].points = 0;
  const Seen seen(map);
  const auto at = [&](int i, int j) { return seen.at(seen.page.planes.at(map.grid.x_m(i), map.grid.y_m(j))); };
  CHECK(same(at(5, 15), plane_colour(0)));
  CHECK(same(at(5, 38), plane_colour(1)));
  CHECK(same(at(20, 10), no_label));
  CHECK(same(at(20, 5), no_data));
}

TEST_CASE("picture: a few high cells do not take the colours from the ground") {
  Map map = street();
  for (int i = 0; i < 10; ++i) map.cells[map.grid.at(i, 0)].height_m = 5;  // 10 of 1600
  CHECK(height_range(map).low_m == 0);
  CHECK(height_range(map).high_m == 0.12);
}

TEST_CASE("picture: the colours of the 14 largest planes differ, whatever their labels") {
  for (std::size_t a = 0; a < 14; ++a) {
    for (std::size_t b = 0; b < a; ++b) CHECK_FALSE(same(plane_colour(a), plane_colour(b)));
  }
  Map map = street();
  for (MapCell& cell : map.cells) cell.label = cell.label == 0 ? 28 : 0;
  const Seen seen(map);
  CHECK(same(seen.at(seen.page.planes.at(1, 0.5)), plane_colour(0)));
  CHECK(same(seen.at(seen.page.planes.at(1, 1.85)), plane_colour(1)));
}

TEST_CASE("picture: a wall on a plane, however large, does not take the colours from the ground") {
  Map map = street();
  map.planes = {{0, 0, 0, 0.01, 0}, {0.12, 0, 0, 0.01, 1}};
  for (int i = 0; i < 10; ++i) {
    for (int j = 0; j < 10; ++j) map.cells[map.grid.at(i, j)].height_m = 1.0 + 0.3 * i;
  }
  CHECK(height_range(map).low_m == 0);
  CHECK(height_range(map).high_m == 0.12);
}

TEST_CASE("picture: the legend lists curbs that are drawn, and no others") {
  const auto rows = [](const Map& map, const PictureExtras& extras = {}) { return legend_height(map, extras) / 20; };
  Map map = street();
  const double before = rows(map);
  map.curbs.push_back({-3, 1, -1, 1, 0, 0, 1, "crease"});
  CHECK(rows(map) == before);
  CHECK(rows(map, {.truth = {map.curbs.back()}}) == before);
  map.curbs.back().x1_m = 1;
  CHECK(rows(map) == before + 1);
  CHECK(rows(map, {.truth = {map.curbs.back()}}) == before + 2);
}

TEST_CASE("picture: a crease is dotted, the edge of a ramp is not") {
  const auto longest_dash = [](const char* kind) {
    Map map = street();
    map.curbs = {{2, -1.5, 2, 1.5, 0, 0, 1, kind}};
    const Seen seen(map);
    const Pixel from = seen.page.planes.at(2, 1.4), to = seen.page.planes.at(2, -1.4);
    int longest = 0, dash = 0;
    for (double x = from.x; x < to.x; ++x) {
      dash = seen.at({x, from.y}).g < 0.3 ? dash + 1 : 0;
      longest = std::max(longest, dash);
    }
    return longest;
  };
  CHECK(longest_dash("crease") > 0);
  CHECK(longest_dash("ramp_edge") > 3 * longest_dash("crease"));
}

TEST_CASE("picture: an SVG can be searched for a curb's height and bears its title") {
  CHECK(described(street()) == "curbs: +12 cm");
  CHECK(drawn(street(), "a.svg", {.title = "M\xc3\xbcnchner & <new>"}).find("<title>M\xc3\xbcnchner &amp; &lt;new>") !=
        std::string::npos);
}

TEST_CASE("picture: a title that is not UTF-8 or holds control characters is still drawn") {
  CHECK(drawn(street(), "a.svg", {.title = "caf\xe9\n"}).find("<title>caf? </title>") != std::string::npos);
  CHECK(size_of_png(drawn(street(), "a.png", {.title = std::string(5000, 'W')})).width <= 1600);
  CHECK(printable("\xed\xa0\x80") == "???");  // half a surrogate pair
  CHECK(printable("\xc3\xa9\xf0\x9f\x99\x82") == "\xc3\xa9\xf0\x9f\x99\x82");
}

TEST_CASE("picture: a map without cells, without valid cells or with one is drawn") {
  for (const char* name : {"a.png", "a.svg"}) {
    CHECK_FALSE(drawn(Map{}, name).empty());
    CHECK_FALSE(drawn(window(40, 40), name).empty());
    Map map = window(40, 40);
    map.cells[700] = {1, 1, -0.8, 1e-4, 1, -1, 0};
    CHECK_FALSE(drawn(map, name).empty());
  }
}

TEST_CASE("picture: the same map gives the same bytes") {
  const PictureExtras extras{.title = "street", .truth = street().curbs, .robot = RobotMarker{1, 0, 0.5}};
  CHECK(drawn(street(), "a.png", extras) == drawn(street(), "a.png", extras));
  CHECK(drawn(street(), "a.svg", extras) == drawn(street(), "a.svg", extras));
}

TEST_CASE("picture: truth is drawn beneath the curbs, and the robot where it stands") {
  const RobotMarker robot{1, -1, std::numbers::pi / 2};
  const Seen without(street()), seen(street(), {.truth = {{0, -1.5, 4, -1.5, 0.1, 0, 1, "step_up"}}, .robot = robot});
  const View& panel = seen.page.planes;
  const auto is_red = [](const Colour& c) { return c.r > 0.8 && c.g < 0.1; };
  Pixel ahead = panel.at(1, -1);
  ahead.x -= 10;  // heading left
  CHECK(is_red(seen.at(ahead)));
  CHECK_FALSE(is_red(without.at(ahead)));
  int dashes = 0;
  for (int n = 0; n < 100; ++n) dashes += seen.at(panel.at(0.04 * n, -1.5)).g < 0.3;
  CHECK(dashes > 50);
  CHECK(dashes < 90);
}

TEST_CASE("picture: where it cannot be written, the error names the file and nothing is left") {
  const TemporaryDirectory dir;
  CHECK(
      error_of([&] { draw_picture(street(), dir.path("none") + "/a.png"); }).starts_with("a.png: cannot be written: "));
  fs::create_directory(dir.path("b.svg"));
  CHECK_THROWS_AS(draw_picture(street(), dir.path("b.svg")), BadInput);
  CHECK(std::distance(fs::directory_iterator(dir.path("")), fs::directory_iterator()) == 1);
  CHECK(fs::is_empty(dir.path("b.svg")));
}

TEST_CASE("picture: a picture takes the place of the one before and leaves nothing beside it") {
  const TemporaryDirectory dir;
  draw_picture(street(), dir.write("a.png", "old"));
  CHECK(read_file(dir.path("a.png")).starts_with("\x89PNG"));
  CHECK(std::distance(fs::directory_iterator(dir.path("")), fs::directory_iterator()) == 1);
}

TEST_CASE("picture texts: adjoining pieces of like height on one line have one text") {
  std::vector<MapCurb> pieces;
  for (int n = 0; n < 8; ++n) pieces.push_back({0.5 * n, 1, 0.5 * n + 0.45, 1.02, 0.115 + 0.001 * n, 0, 1, "step_up"});
  std::swap(pieces[1], pieces[6]);
  const std::vector<MapCurb> runs = joined(pieces, 0.15);
  REQUIRE(runs.size() == 1);
  CHECK(std::min(runs[0].x0_m, runs[0].x1_m) == 0);
  CHECK(std::max(runs[0].x0_m, runs[0].x1_m) == 3.95);
  CHECK(runs[0].height_m == Approx(0.1185).margin(1e-3));
  CHECK(words_of(place_heights(runs, pieces, view, {}, seven_pixels_a_letter)) == Words{"+12 cm"});
}

TEST_CASE("picture texts: pieces of other height, kind or line, or beyond a gap, keep their own") {
  const MapCurb curb{0, 1, 2, 1, 0.12, 0, 1, "step_up"};
  const auto runs_with = [&](const MapCurb& other) { return joined(std::vector{curb, other}, 0.15).size(); };
  CHECK(runs_with({2, 1, 3, 1, 0.12, 0, 1, "step_up"}) == 1);
  CHECK(runs_with({2, 1, 3, 1, 0.15, 0, 1, "step_up"}) == 2);
  CHECK(runs_with({2, 1, 3, 1, 0.12, 0, 1, "crease"}) == 2);
  CHECK(runs_with({2, 1, 2, 2, 0.12, 0, 1, "step_up"}) == 2);
  CHECK(runs_with({2.3, 1, 3, 1, 0.12, 0, 1, "step_up"}) == 2);
}

TEST_CASE("picture texts: signs, whole centimetres, and none for what rounds to nothing") {
  const std::vector<MapCurb> curbs{{1, -1, 1, 1, 0.116, 0, 1, "step_up"},
                                   {2, -1, 2, 0.9, -0.084, 0, 1, "step_down"},
                                   {3, -1, 3, 0.8, 0.004, 0, 1, "crease"},
                                   {3.5, -1, 3.5, 0.7, std::nan(""), 0, 1, "step_up"}};
  CHECK(words_of(place_heights(joined(curbs, 0.15), curbs, view, {}, seven_pixels_a_letter)) ==
        Words{"+12 cm", "-8 cm"});
}

TEST_CASE("picture texts: none lies on another, on a curb or outside, and the longest curb has its own") {
  std::vector<MapCurb> curbs;
  for (int n = 0; n < 60; ++n) {
    const double angle = 2.4 * n, x = 2 + 1.7 * std::cos(1.3 * n), y = 1.7 * std::sin(1.7 * n), length = 0.3 + 0.01 * n;
    curbs.push_back(
        {x, y, x + length * std::cos(angle), y + length * std::sin(angle), 0.01 * (n + 1), 0, 1, "step_up"});
  }
  curbs.push_back({0, -1.9, 4, 1.9, 0.99, 0, 1, "step_up"});
  const auto texts = place_heights(joined(curbs, 0.15), curbs, view, {{180, 180, 40, 40}}, seven_pixels_a_letter);
  CHECK(texts.size() > 10);
  CHECK(texts.size() < curbs.size());
  CHECK(texts.front().words == "+99 cm");
  for (std::size_t n = 0; n < texts.size(); ++n) {
    CHECK(inside(texts[n].box, view.box));
    CHECK_FALSE(overlap(texts[n].box, {180, 180, 40, 40}));
    for (std::size_t m = 0; m < n; ++m) CHECK_FALSE(overlap(texts[n].box, texts[m].box));
    if (n > 0) CHECK(is_free(texts[n].box, view, {}, curbs));
  }
}

TEST_CASE("picture texts: in a panel too narrow for a place beside it, a long curb bears its height on its line") {
  const View narrow{0, 20, -1, 1, {0, 0, 60, 600}};
  const std::vector<MapCurb> curbs{{0, 0, 20, 0, 0.1, 0, 1, "step_up"}};
  const auto texts = place_heights(curbs, curbs, narrow, {}, seven_pixels_a_letter);
  REQUIRE(texts.size() == 1);
  CHECK(texts[0].box.x + 0.5 * texts[0].box.width == Approx(30));
}

TEST_CASE("picture texts: a plane bears its label on one of its own cells") {
  Map map = window(40, 40);
  const auto label_at = [&](int i, int j) -> int& {
    map.cells[map.grid.at(i, j)].points = 1;
    return map.cells[map.grid.at(i, j)].label;
  };
  for (int n = 0; n < 40; ++n) {  // an L, whose middle lies outside it
    for (int wide = 0; wide < 6; ++wide) label_at(n, wide) = label_at(wide, n) = 7;
  }
  label_at(30, 30) = 8;  // smaller than its text
  const auto texts = place_labels(map, view, {}, seven_pixels_a_letter);
  REQUIRE(words_of(texts) == Words{"7"});
  const Box& box = texts[0].box;
  const int i = static_cast<int>((400 - box.y - 0.5 * box.height) / 10),
            j = static_cast<int>((400 - box.x - 0.5 * box.width) / 10);
  CHECK(map.cells[map.grid.at(i, j)].label == 7);
  CHECK(place_labels(map, view, {view.box}, seven_pixels_a_letter).empty());
}

TEST_CASE("picture ticks: round numbers that include the ends and leave room for their texts") {
  const auto words = [](double low, double high, double px_per_unit, double room) {
    Words result;
    for (const Tick& tick : ticks(low, high, px_per_unit, [&](const std::string&) { return room; })) {
      result.push_back(tick.words);
    }
    return result;
  };
  CHECK(words(-2, 2, 100, 90) == Words{"-2", "-1", "0", "1", "2"});
  CHECK(words(-2, 2, 100, 40) == Words{"-2.0", "-1.5", "-1.0", "-0.5", "0.0", "0.5", "1.0", "1.5", "2.0"});
  CHECK(words(-2, 2, 10, 15) == Words{"-2", "0", "2"});
  CHECK(words(0.1, 0.4, 1000, 90) == Words{"0.1", "0.2", "0.3", "0.4"});
  CHECK(words(431250.52, 431251.08, 1000, 190) == Words{"431250.6", "431250.8", "431251.0"});
  CHECK(words(0, 51.2, 1, 9) == Words{"0", "10", "20", "30", "40", "50"});
}
