// What the runs of a plane's cells say about it.
#include "curbline/planes/strip_tally.hpp"

#include <array>
#include <catch2/catch.hpp>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::small_limits;

/// A map, and the plane of each cell's region.
struct Map {
  Map() {
    const Settings settings = test::small_settings();
    dem.init(settings.window, settings.planes.prior);
    labels.fill(no_label);
  }
  void see(int i, int j, Label label, float height_m, float across = 0.5f) {
    dem.add({0.1f * (static_cast<float>(i) + across), 0.1f * static_cast<float>(j) + 0.05f, height_m, 1e-4f});
    labels[dem.slot(i, j)] = label;
  }
  StripTally tally(Label of, const Viewpoint& view, const std::array<Plane, small_limits.planes>& planes = {}) const {
    const Obstacles<small_limits> obstacles(dem, planes, view, labels);
    return StripTallies<small_limits>(dem, planes, view, labels, obstacles)[of];
  }

  Dem<small_limits> dem{};
  CellLabels<small_limits> labels{};
};

// _______
//        `              two cells on one row, four apart, in the shadow of a step; on other rows nothing lies beyond
//           ` ____
TEST_CASE("strip tally: of a strip the cells that are seen count, as of its plane, not those between") {
  Map map;
  for (int i = 0; i < 24; ++i) {
    if (i < 10 || i > 14) map.see(i, 12, i < 10 ? 0 : 2, i < 10 ? 0.0f : -0.15f);
  }
  map.see(10, 12, 1, -0.03f);
  map.see(14, 12, 1, -0.12f);
  for (int j = 0; j < 8; ++j) map.see(10, j, 1, -0.03f);
  const StripTally tally = map.tally(1, {-2.5f, 1.25f, 1.0f});
  CHECK(tally.cells == 10.0f);
  CHECK(tally.shadow[0].cells == 2.0f);
}

/// Is a strip of so many rows of cells a face, between a road and a pavement 12 cm higher? height(across, k): its share
/// of the step, in row k of the strip, from 0 to 1 across the row.
template <typename Height>
bool face(int cells, Height&& height) {
  Map map;
  for (int i = 0; i < 24; ++i) {
    const int k = i - 10;
    for (int j = 0; j < 24; ++j) {
      for (int n = 0; n < 12; ++n) {
        const float across = (static_cast<float>(n) + 0.5f) / 12.0f, noise_m = n % 2 == 0 ? 0.002f : -0.002f;
        const float share = k < 0 ? 0.0f : k >= cells ? 1.0f : height(across, k);
        map.see(i, j, k < 0 ? 0 : k >= cells ? 2 : 1, 0.12f * share + noise_m, across);
      }
    }
  }
  return map.tally(1, {0.0f, 1.2f, 1.0f}).face();
}

//            _____
//           |            on the border between two rows, which see more of road and pavement than of the face
//  _________|
TEST_CASE("strip tally: a face is one on the border between two rows of cells, too, however little is seen of it") {
  const auto readings_on_face = [](float part) {
    return face(2, [=](float across, int k) {
      if (k == 0) return across < 1.0f - part ? 0.0f : 0.5f * (across - (1.0f - part)) / part;
      return across < part ? 0.5f + 0.5f * across / part : 1.0f;
    });
  };
  CHECK(readings_on_face(0.5f));
  CHECK(readings_on_face(0.25f));
  CHECK(readings_on_face(0.125f));
}

//            _____             _____
//         __|                /           a tread one or two rows of cells wide; a slope of two
//  ______|           ______/
TEST_CASE("strip tally: a level tread is no face, nor is a slope of two cells") {
  for (const float level : {0.1f, 0.3f, 0.5f}) {
    CHECK_FALSE(face(1, [=](float, int) { return level; }));
    CHECK_FALSE(face(2, [=](float, int) { return level; }));
    CHECK_FALSE(face(2, [=](float across, int k) { return k == 0 && across < 0.2f ? 0.0f : level; }));
  }
  CHECK_FALSE(face(2, [](float across, int k) { return 0.5f * (across + static_cast<float>(k)); }));
  CHECK_FALSE(face(3, [](float across, int k) {  // whose end cells hold something of both sides
    if (k == 0 && across < 0.75f) return 0.0f;
    return k == 2 && across > 0.25f ? 1.0f : 0.5f;
  }));
}

/// Of 20 strips beside an edge of 12 cm, all as narrow as the laser's spot, that all rise by so much of it together.
bool blurred(float cells_a_strip, float rise_m) {
  StripTally tally;
  tally.strips = 20.0f;
  tally.cells = tally.strip_cells = tally.blurred_cells[0] = cells_a_strip * tally.strips;
  tally.step_m = 0.12f * tally.strips;
  tally.along_step_m = rise_m;
  return tally.blurred_edge();
}

//       ____         ____
//    --'          __|        of strips of two cells those of a blur lead from one plane to the other, a tread is level
// __|          __|
TEST_CASE("strip tally: strips of which hardly any has two cells tell no tread, whatever those few do") {
  CHECK(blurred(2.0f, 1.2f));
  CHECK_FALSE(blurred(2.0f, 0.0f));
  CHECK(blurred(1.05f, 0.0f));
}

TEST_CASE("strip tally: the laser's spot on an edge aslant is as long on its one side as on the other") {
  const auto blurred_cells = [](float aside_m) {
    Map map;
    for (int i = 0; i < 24; ++i) map.see(i, 12, i < 10 ? 0 : i > 10 ? 2 : 1, i < 10 ? 0.0f : i > 10 ? -0.15f : -0.07f);
    std::array<Plane, small_limits.planes> planes{};
    for (Plane& plane : planes) plane.x_m = 1.05f, plane.y_m = 1.25f, plane.cells = 10.0f;
    planes[1].slope_x = planes[1].slope_y = -1.0f;
    planes[1].pxx = planes[1].pxy = 1.0f;
    return map.tally(1, {-1.0f, 1.25f + aside_m, 1.2f}, planes).blurred_cells[0];
  };
  CHECK(blurred_cells(1.0f) > 2.0f);  // an edge at 45 degrees, and the spot
  CHECK(blurred_cells(1.0f) == Approx(blurred_cells(-1.0f)));
}

}  // namespace
}  // namespace curbline
