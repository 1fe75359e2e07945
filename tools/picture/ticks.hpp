// The round numbers on an axis or a colour bar.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace curbline::tools::picture {

struct Tick {
  double value = 0;
  std::string words;
};

/// Multiples of 1, 2 or 5 times a power of ten from low to high, as dense as possible: room_px for each text, and at
/// most ten steps. Units are those of the axis, px_per_unit is their size on the page.
std::vector<Tick> ticks(double low, double high, double px_per_unit,
                        const std::function<double(const std::string&)>& room_px);

}  // namespace curbline::tools::picture
