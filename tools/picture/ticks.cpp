#include "picture/ticks.hpp"

#include <algorithm>
#include <cmath>

#include "formats/decimals.hpp"

namespace curbline::tools::picture {
namespace {

constexpr double slack = 1e-6;  // in steps: tolerance for rounding at the ends

std::vector<Tick> multiples(double low, double high, double step) {
  std::vector<Tick> result;
  const int places = std::max(0, -static_cast<int>(std::floor(std::log10(step) + slack)));
  for (double k = std::ceil(low / step - slack); k * step <= high + slack * step; ++k) {
    result.push_back({k * step, decimals(k == 0 ? 0.0 : k * step, places)});
  }
  return result;
}

}  // namespace

std::vector<Tick> ticks(double low, double high, double px_per_unit,
                        const std::function<double(const std::string&)>& room_px) {
  for (double power = std::pow(10.0, std::floor(std::log10((high - low) / 10)));; power *= 10) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double step = factor * power;
      if ((high - low) / step > 10 + slack) continue;
      std::vector<Tick> result = multiples(low, high, step);
      const auto fits = [&](const Tick& tick) { return room_px(tick.words) <= step * px_per_unit; };
      if (result.size() < 2 || std::all_of(result.begin(), result.end(), fits)) return result;
    }
  }
}

}  // namespace curbline::tools::picture
