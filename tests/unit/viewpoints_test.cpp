// The places from which a laser has seen, under numbers small enough for a cell to store.
#include "curbline/map/viewpoints.hpp"

#include <catch2/catch.hpp>

namespace curbline {
namespace {

TEST_CASE("viewpoints: a laser that stands sees from one place, exactly there") {
  Viewpoints views;
  views.init(4.0f);
  for (int line = 0; line < 100; ++line) views.look_from({0.3f, -1.7f});
  CHECK_FALSE(views.moved());
  CHECK(views.newest() == 0);
  CHECK(views.at(0).x_m == 0.3f);
  CHECK(views.at(0).y_m == -1.7f);
}

TEST_CASE("viewpoints: one that drives sees from the middle of each stretch, a window's side back and more") {
  Viewpoints views;
  views.init(4.0f);
  int number = -1, stretches = 0;
  for (int line = 0; line <= 2000; ++line) {
    const auto x_m = 0.01f * static_cast<float>(line);
    views.look_from({x_m, 5.0f});
    stretches += views.newest() != number;
    number = views.newest();
    CHECK(views.at(number).x_m == Approx(x_m).margin(0.09));
  }
  CHECK(views.moved());
  CHECK(stretches == Approx(20.0 * 24 / 4).margin(8));
  const auto back = [&](int age) { return views.at((number + Viewpoints::numbers - age) % Viewpoints::numbers).x_m; };
  for (int age = 1; age < Viewpoints::numbers; ++age) CHECK(back(age - 1) - back(age) == Approx(0.17).margin(0.1));
  CHECK(back(Viewpoints::numbers - 1) < 20.0f - 5.0f);
}

TEST_CASE("viewpoints: a laser that trembles has not moved") {
  Viewpoints views;
  views.init(4.0f);
  for (int line = 0; line < 100; ++line) views.look_from({line % 2 == 0 ? 0.0f : 0.1f, 0.0f});
  CHECK_FALSE(views.moved());
}

}  // namespace
}  // namespace curbline
