// The places from which a laser has seen, under numbers small enough for a cell to store.
#include "curbline/map/laser_way.hpp"

#include <catch2/catch.hpp>

namespace curbline {
namespace {

TEST_CASE("laser way: a laser that stands sees from one place, exactly there") {
  LaserWay way;
  way.init(4.0f);
  for (int line = 0; line < 100; ++line) way.look_from({0.3f, -1.7f});
  CHECK_FALSE(way.moved());
  CHECK(way.newest() == 0);
  CHECK(way.at(0).x_m == 0.3f);
  CHECK(way.at(0).y_m == -1.7f);
}

TEST_CASE("laser way: one that drives sees from the middle of each stretch, a window's side back and more") {
  LaserWay way;
  way.init(4.0f);
  int number = -1, stretches = 0;
  for (int line = 0; line <= 2000; ++line) {
    const auto x_m = 0.01f * static_cast<float>(line);
    way.look_from({x_m, 5.0f});
    stretches += way.newest() != number;
    number = way.newest();
    CHECK(way.at(number).x_m == Approx(x_m).margin(0.09));
  }
  CHECK(way.moved());
  CHECK(stretches == Approx(20.0 * 24 / 4).margin(8));
  const auto back = [&](int age) { return way.at((number + LaserWay::numbers - age) % LaserWay::numbers).x_m; };
  for (int age = 1; age < LaserWay::numbers; ++age) CHECK(back(age - 1) - back(age) == Approx(0.17).margin(0.1));
  CHECK(back(LaserWay::numbers - 1) < 20.0f - 5.0f);
}

TEST_CASE("laser way: a laser that trembles has not moved") {
  LaserWay way;
  way.init(4.0f);
  for (int line = 0; line < 100; ++line) way.look_from({line % 2 == 0 ? 0.0f : 0.1f, 0.0f});
  CHECK_FALSE(way.moved());
}

}  // namespace
}  // namespace curbline
