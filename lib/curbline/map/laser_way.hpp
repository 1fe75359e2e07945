// From where a driving laser has seen cells: a ring of the newest places on its way, a 24th of the window's side apart,
// each with a number of five bits that a cell can store. It covers 4/3 of that side; an older cell's number has been
// reused for a later place. O(1).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace curbline {

class LaserWay {
 public:
  static constexpr int numbers = 32;

  struct Position {
    float x_m = 0.0f, y_m = 0.0f;  ///< map frame
  };

  void init(float window_side_m) {
    *this = LaserWay{};
    apart_m_ = window_side_m * (1.0f / 24);
  }

  /// The laser is at this place.
  void look_from(const Position& position) {
    const float dx_m = position.x_m - began_.x_m, dy_m = position.y_m - began_.y_m;
    if (places_ == 0 || dx_m * dx_m + dy_m * dy_m > apart_m_ * apart_m_) {
      began_ = position;
      ++places_;
    }
    at_[static_cast<std::size_t>(newest())] = {0.5f * (began_.x_m + position.x_m), 0.5f * (began_.y_m + position.y_m)};
  }

  /// Has the laser left its first place?
  bool moved() const { return places_ > 1; }
  /// Number of the current place; after look_from().
  int newest() const { return static_cast<int>((places_ - 1) % numbers); }
  /// The middle of the stretch of the way with this number. 0 <= number < numbers.
  const Position& at(int number) const { return at_[static_cast<std::size_t>(number)]; }

 private:
  std::array<Position, numbers> at_{};
  Position began_{};  ///< start of the newest stretch
  float apart_m_ = 0.0f;
  std::uint32_t places_ = 0;  ///< so far; 2^32 are 700,000 km in windows of 4 m
};

}  // namespace curbline
