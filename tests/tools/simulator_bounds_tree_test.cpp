#include "simulator/bounds_tree.hpp"

#include <catch2/catch.hpp>

#include "simulator/random.hpp"

using namespace curbline::tools;

TEST_CASE("bounds tree: it finds what a look at every box finds, in order") {
  Random random(1);
  std::vector<Bounds> boxes;
  const auto box = [&](double side_m) {
    const double x = 100 * random.uniform(), y = 100 * random.uniform();
    return Bounds{x, y, x + side_m * random.uniform(), y + side_m * random.uniform()};
  };
  for (int i = 0; i < 500; ++i) boxes.push_back(box(i % 50 == 0 ? 80 : 3));
  const BoundsTree tree(boxes);
  for (int look = 0; look < 300; ++look) {
    const Bounds here = box(10);
    std::vector<std::size_t> expected;
    for (std::size_t k = 0; k < boxes.size(); ++k) {
      if (overlap(boxes[k], here)) expected.push_back(k);
    }
    CHECK(tree.overlapping(here) == expected);
  }
}

TEST_CASE("bounds tree: boxes that touch are found, and in no boxes none") {
  CHECK(BoundsTree({}).overlapping({0, 0, 1, 1}).empty());
  CHECK(BoundsTree({{1, 1, 2, 2}}).overlapping({0, 0, 1, 1}).size() == 1);
  CHECK(BoundsTree({{1.1, 1, 2, 2}}).overlapping({0, 0, 1, 1}).empty());
}
