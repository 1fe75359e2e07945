// Where the robot saw the ground: within one 10 cm cell of a valid cell. Curbs elsewhere count neither as missed nor as
// false.
#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_set>

namespace curbline::tools {

class Seen {
 public:
  static constexpr double cell_m = 0.1;

  void add(double x_m, double y_m) {
    if (!valid_.insert(key(index(x_m), index(y_m))).second) return;
    for (int di = -1; di <= 1; ++di) {
      for (int dj = -1; dj <= 1; ++dj) near_.insert(key(index(x_m) + di, index(y_m) + dj));
    }
  }
  bool operator()(double x_m, double y_m) const { return near_.contains(key(index(x_m), index(y_m))); }

 private:
  static std::int64_t index(double metres) { return static_cast<std::int64_t>(std::floor(metres / cell_m)); }
  static std::int64_t key(std::int64_t i, std::int64_t j) { return i * (std::int64_t{1} << 32) + j; }

  std::unordered_set<std::int64_t> valid_, near_;
};

}  // namespace curbline::tools
