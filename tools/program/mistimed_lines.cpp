#include "program/mistimed_lines.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <numbers>
#include <utility>

#include "map/median.hpp"

namespace curbline::tools {
namespace {

constexpr int beside = 3;                    ///< lines before a line, and after it
constexpr std::size_t run = 2 * beside + 1;  ///< with the line itself, which is number `beside`
constexpr int sectors = 180;                 ///< of a turn: two beams or more of any laser of 1 degree
constexpr std::size_t least_sectors = 10;    ///< in which a line has to be seen among its neighbours
constexpr double reach_m = 1000;             ///< of any laser
constexpr double chance_sd = 4;              ///< one line in 16,000 by chance; clouds have some hundreds

/// Standard deviation of a normal distribution about 0 with the median magnitude of these values.
double deviation(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  return 1.4826 * median(std::move(values));
}

/// A line's turn about a horizontal axis through the laser, radians: what lies in direction (x, y) is lifted by
/// x * ahead + y * left.
using Turn = Eigen::Vector2d;
/// Lines that are turned, by their number.
using Turns = std::map<int, Turn>;

Eigen::Vector2d direction(double bearing_rad) {
  return {std::cos(bearing_rad), std::sin(bearing_rad)};
}

/// Where in the scan a point is: `sector` counts on from line to line.
struct Place {
  int sector = 0;
  int line() const { return static_cast<int>(std::floor(static_cast<double>(sector) / sectors)); }
};

/// The place of each point. Empty if points are not in the order of their bearings.
std::vector<Place> places_of(std::span<const Point3> cloud) {
  constexpr double step = 2.0 / 360;  // of a turn: largest between two beams that both return
  const auto turn = [](const Point3& p) { return std::atan2(p.y, p.x) / (2 * std::numbers::pi); };
  std::vector<double> steps;
  for (std::size_t k = 1; k < cloud.size(); ++k) {
    const double by = turn(cloud[k]) - turn(cloud[k - 1]);
    steps.push_back(by - std::round(by));
  }
  const auto left = std::ranges::count_if(steps, [](double by) { return by > 0 && by < step; });
  const auto right = std::ranges::count_if(steps, [](double by) { return by < 0 && by > -step; });
  if (cloud.empty() || 10 * std::max(left, right) < 9 * std::ssize(steps)) return {};
  const double sense = left > right ? 1 : -1;
  double turns = 0.5 + sense * turn(cloud[0]);
  const auto place = [&] { return Place{static_cast<int>(std::floor(turns * sectors))}; };
  std::vector<Place> places{place()};
  for (const double by : steps) {
    const double forward = sense * by;
    turns += forward < -step ? forward + 1 : forward;  // back by no more than its noise
    places.push_back(place());
  }
  return places;
}

/// What a line shows in a sector: medians over its points.
struct Sight {
  int line = 0;
  double bearing_rad = 0, distance_m = 0, height_m = 0;
};

/// By sector of the turn, each in the order of lines, without those that are turned, nor points out of a laser's reach.
std::array<std::vector<Sight>, sectors> sights_of(std::span<const Point3> cloud, std::span<const Place> places,
                                                  const Turns& turned) {
  struct Values {
    double bearing_rad = 0;
    std::vector<double> distances_m, heights_m;
  };
  std::map<int, Values> by_place;
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    const Point3& p = cloud[k];
    const double distance_m = std::hypot(p.x, p.y);
    if (turned.contains(places[k].line()) || std::max(distance_m, std::abs(p.z)) > reach_m) continue;
    Values& values = by_place[places[k].sector];
    values.bearing_rad = std::atan2(p.y, p.x);
    values.distances_m.push_back(distance_m);
    values.heights_m.push_back(p.z);
  }
  std::array<std::vector<Sight>, sectors> sights;
  for (auto& [sector, values] : by_place) {
    const int line = Place{sector}.line();
    sights[static_cast<std::size_t>(sector - line * sectors)].push_back(
        {line, values.bearing_rad, median(std::move(values.distances_m)), median(std::move(values.heights_m))});
  }
  return sights;
}

/// Do the lines follow each other, with two left out at most, towards the laser or away from it, over a surface that is
/// less steep than 45 degrees? Along a wall a turn moves points within the wall.
bool comparable(std::span<const Sight> lines) {
  const Sight &first = lines.front(), &last = lines.back();
  if (last.line - first.line > static_cast<int>(run) + 1) return false;
  if (!(std::abs(last.height_m - first.height_m) < std::abs(last.distance_m - first.distance_m))) return false;
  const auto at_m = [](const Sight& sight) { return sight.distance_m; };
  return std::ranges::adjacent_find(lines, std::ranges::greater_equal{}, at_m) == lines.end() ||
         std::ranges::adjacent_find(lines, std::ranges::less_equal{}, at_m) == lines.end();
}

/// Angles by which the lines of a run lie above the straight line through those beside the middle one.
std::array<double, run> offsets_rad(std::span<const Sight> lines) {
  std::vector<double> slopes, levels_m;
  for (std::size_t a = 0; a < run; ++a) {
    for (std::size_t b = a + 1; b < run; ++b) {
      if (a == beside || b == beside) continue;
      slopes.push_back((lines[b].height_m - lines[a].height_m) / (lines[b].distance_m - lines[a].distance_m));
    }
  }
  const double slope = median(std::move(slopes));
  const auto level_m = [&](std::size_t k) { return lines[k].height_m - slope * lines[k].distance_m; };
  for (std::size_t k = 0; k < run; ++k) {
    if (k != beside) levels_m.push_back(level_m(k));
  }
  const double straight_m = median(std::move(levels_m));
  std::array<double, run> offsets{};
  for (std::size_t k = 0; k < run; ++k) offsets[k] = (level_m(k) - straight_m) / lines[k].distance_m;
  return offsets;
}

/// A line among its neighbours, in each sector where it is seen with all of them.
struct Comparison {
  std::vector<double> bearings_rad;
  std::array<std::vector<double>, run> offsets_rad;

  /// Of the line, or of one beside it, all along.
  double offset_rad(std::size_t k = beside) const { return median(offsets_rad[k]); }
  double largest_beside_rad() const {
    double most = 0;
    for (std::size_t k = 0; k < run; ++k) {
      if (k != beside) most = std::max(most, std::abs(offset_rad(k)));
    }
    return most;
  }
  /// What the offsets of the line differ by from sector to sector.
  std::vector<double> differences_rad() const {
    const double offset = offset_rad();
    std::vector<double> differences = offsets_rad[beside];
    for (double& rad : differences) rad -= offset;
    return differences;
  }
  /// Deviation of offset_rad(): of the median of a normal sample, which is 1.25 times that of its mean.
  double offset_sd_rad() const {
    return 1.25 * deviation(differences_rad()) / std::sqrt(static_cast<double>(bearings_rad.size()));
  }
  Turn turn() const;
};

/// Bayesian least squares: about both axes it is expected to be as large as the offset, as sectors close together show
/// a turn about one axis alone. Sectors farther off the others than three deviations, at a step, count as three.
Turn Comparison::turn() const {
  const double expected_rad = offset_rad();
  const std::vector<double> differences = differences_rad();
  const double noise_rad = std::max(deviation(differences), 1e-3 * std::abs(expected_rad));
  Eigen::Matrix2d information = Eigen::Matrix2d::Identity() * (noise_rad * noise_rad / (expected_rad * expected_rad));
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::size_t s = 0; s < differences.size(); ++s) {
    const Eigen::Vector2d towards = direction(bearings_rad[s]);
    information += towards * towards.transpose();
    sum += towards * (expected_rad + std::clamp(differences[s], -3 * noise_rad, 3 * noise_rad));
  }
  return information.ldlt().solve(sum);
}

/// Lines that are seen among their neighbours in enough sectors.
std::map<int, Comparison> compare(std::span<const std::vector<Sight>> sights) {
  std::map<int, Comparison> lines;
  for (const std::vector<Sight>& sector : sights) {
    for (std::size_t first = 0; first + run <= sector.size(); ++first) {
      const auto neighbours = std::span(sector).subspan(first, run);
      if (!comparable(neighbours)) continue;
      Comparison& line = lines[neighbours[beside].line];
      line.bearings_rad.push_back(neighbours[beside].bearing_rad);
      const std::array<double, run> offsets = offsets_rad(neighbours);
      for (std::size_t k = 0; k < run; ++k) line.offsets_rad[k].push_back(offsets[k]);
    }
  }
  std::erase_if(lines, [](const auto& line) { return line.second.bearings_rad.size() < least_sectors; });
  return lines;
}

/// Adds the lines that lie off their neighbours. Are there any?
bool find_turned(const std::map<int, Comparison>& lines, Turns& turned) {
  if (lines.empty()) return false;
  std::vector<double> offsets;
  for (const auto& [number, line] : lines) offsets.push_back(line.offset_rad());
  const double chance_rad = deviation(std::move(offsets));
  const auto before = turned.size();
  for (const auto& [number, line] : lines) {
    const double off_rad = std::abs(line.offset_rad());
    const double by_chance_rad = std::hypot(chance_rad, line.offset_sd_rad());
    if (off_rad > chance_sd * by_chance_rad && off_rad > 2 * line.largest_beside_rad()) turned[number] = line.turn();
  }
  return turned.size() > before;
}

}  // namespace

std::vector<double> mistimed_lift_m(std::span<const Point3> cloud) {
  std::vector<double> lift_m(cloud.size(), 0.0);
  const std::vector<Place> places = places_of(cloud);
  if (places.empty()) return lift_m;
  Turns turned;
  while (find_turned(compare(sights_of(cloud, places, turned)), turned)) {  // each uncovers others beside it
  }
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    const auto turn = turned.find(places[k].line());
    if (turn != turned.end()) lift_m[k] = turn->second.dot(Eigen::Vector2d{cloud[k].x, cloud[k].y});
  }
  return lift_m;
}

}  // namespace curbline::tools
