// What lies beyond the ends of a straight piece of borders. What becomes of pieces: curb_tracer_test.cpp.
#include "curbline/curbs/curb_piece.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "curbline/curbs/border_finder.hpp"
#include "curbline/curbs/step_height.hpp"
#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::fill;
using test::small_limits;
using test::small_settings;
using test::Stages;

struct Flank {
  double lower_m;             ///< than the pavement, where it reaches the road
  double unseen_cells = 0.0;  ///< between the two, along the road
  bool mirrored = false;      ///< the pavement lies at high y
};

//  flank   |        a road at x < 1.2 m; beside it a pavement, 12 cm higher, up to the middle of the window, and beyond
//  --------+ road   a flank that rises away from the road; seen from above
//  pavement|
/// By how much the step up to the pavement may be lower, as both ends of its piece tell it, at the flank and away from
/// it.
struct Lower {
  float at_flank_m, elsewhere_m;
};
Lower lower(const Flank& flank) {
  const auto stages = std::make_unique<Stages<small_limits>>(small_settings());
  fill(stages->dem, [&](double x, double y) {
    const double along = (flank.mirrored ? 2.4 - y : y) - 1.2;
    if (along > 0.0 && along < 0.1 * flank.unseen_cells) return std::nan("");
    return x < 1.2 ? 0.0 : along < 0.0 ? 0.12 : 0.12 - flank.lower_m + 0.2 * (x - 1.2);
  });
  stages->settle();
  const CurbSettings settings{};
  const CurbStages<small_limits> curb_stages{stages->dem, stages->mixture, stages->field, stages->view, settings};
  auto& borders = stages->work.curbs().borders;
  borders.clear();
  BorderFinder<small_limits>(curb_stages).find(borders, stages->counters);
  const Label road = stages->label_at(3, flank.mirrored ? 21 : 2),
              pavement = stages->label_at(20, flank.mirrored ? 21 : 2);
  REQUIRE(pavement != stages->label_at(20, flank.mirrored ? 2 : 21));
  for (int b = 0; b < borders.size(); ++b) {
    if (borders.chained(b)) continue;
    const int length = borders.chain(stages->dem, b, settings.link_reach);
    const CurbPiece<small_limits> piece(curb_stages, borders.part(0, length - 1));
    if (piece.first.one != std::min(road, pavement) || piece.first.other != std::max(road, pavement)) continue;
    const bool first_at_flank = std::abs(piece.line.y0_m - 1.2f) < std::abs(piece.line.y1_m - 1.2f);
    const auto variance_m2 = [&](bool first, bool second) {
      auto part = borders.part(0, length - 1);
      part.ends = {first, second};
      CurbPiece<small_limits> anew(curb_stages, part);
      StepHeight<small_limits> height(anew);
      height.refine(part, true);
      return height.variance_m2();
    };
    const auto lower_m = [&](bool first) {  // uniformly by up to as much
      return std::sqrt(3.0f * (variance_m2(first, !first) - variance_m2(false, false)));
    };
    return {lower_m(first_at_flank), lower_m(!first_at_flank)};
  }
  FAIL("no border between road and pavement");
  return {};
}

TEST_CASE("curb piece: beside a flank that labels do not tell from the pavement the step may be as much lower") {
  const bool mirrored = GENERATE(false, true);
  for (const double unseen_cells : {0.0, 1.0}) {  // a scan line may be missing between the two
    const auto [at_flank_m, elsewhere_m] = lower({0.005, unseen_cells, mirrored});
    CHECK(at_flank_m == Approx(0.005).margin(0.001));
    CHECK(elsewhere_m < 1e-4f);
  }
  CHECK(lower({0.005, 2.0, mirrored}).at_flank_m < 1e-4f);
}

TEST_CASE("curb piece: a flank that is clearly lower, or higher, where it begins makes a step no lower") {
  CHECK(lower({0.05}).at_flank_m < 1e-4f);
  CHECK(lower({-0.005}).at_flank_m < 1e-4f);
}

}  // namespace
}  // namespace curbline
