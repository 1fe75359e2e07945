// A bug stops the program by a function that a board can replace, as this file does.
#include "curbline/assertion.hpp"

#include <catch2/catch.hpp>
#include <memory>
#include <stdexcept>

#include "curbline/pipeline.hpp"

void curbline::assertion_failed(const char* what) {
  throw std::logic_error(what);
}

namespace curbline {
namespace {

TEST_CASE("assertion: a board replaces what happens at a bug, and learns what should have held") {
  CHECK_NOTHROW(expects(true, "nothing"));
  CHECK_THROWS_WITH(expects(false, "0 <= label"), "0 <= label");
}

TEST_CASE("assertion: asking for the plane of no label, or of one beyond the limits, is a bug") {
  constexpr Limits small{.rows = 8, .cols = 8, .planes = 4, .beams = 8};
  const auto pipeline = std::make_unique<Pipeline<small>>();
  CHECK_NOTHROW(pipeline->plane(0));
  CHECK_NOTHROW(pipeline->plane(3));
  for (const int label : {-1, 4, int{no_label}}) {
    CHECK_THROWS_WITH(pipeline->plane(label), "plane(): 0 <= label < limits.planes");
  }
}

TEST_CASE("assertion: asking for the surface of a plane beyond the limits is a bug, before init() too") {
  constexpr Limits small{.rows = 8, .cols = 8, .planes = 4, .beams = 8};
  const auto pipeline = std::make_unique<Pipeline<small>>();
  const auto ask = [&] {
    for (const Label label : {Label{0}, Label{3}, no_label}) CHECK(pipeline->surface(label) == label);
    CHECK_THROWS_WITH(pipeline->surface(4), "surface(): label < limits.planes, or no_label");
  };
  ask();
  Settings settings;
  settings.window.rows = settings.window.cols = settings.laser.beams = 8;
  REQUIRE(pipeline->init(settings) == Status::ok);
  ask();
}

}  // namespace
}  // namespace curbline
