#include "picture/texts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <optional>
#include <utility>

namespace curbline::tools::picture {
namespace {

constexpr double like_height_m = 0.02;
constexpr double shortest = 10;  ///< pixels: a text beside a shorter line would be ambiguous

double length_m(const MapCurb& curb) {
  return std::hypot(curb.x1_m - curb.x0_m, curb.y1_m - curb.y0_m);
}

/// A position relative to the line of a piece: the distance along it from its first end, and the distance beside it.
struct Beside {
  double along_m, across_m;
};

class Axis {
 public:
  explicit Axis(const MapCurb& curb) : from_(curb), length_m_(length_m(curb)) {
    if (length_m_ > 0) ux_ = (curb.x1_m - curb.x0_m) / length_m_, uy_ = (curb.y1_m - curb.y0_m) / length_m_;
  }
  Beside beside(double x_m, double y_m) const {
    const double dx = x_m - from_.x0_m, dy = y_m - from_.y0_m;
    return {ux_ * dx + uy_ * dy, ux_ * dy - uy_ * dx};
  }
  double length() const { return length_m_; }

 private:
  const MapCurb& from_;
  double length_m_, ux_ = 1, uy_ = 0;
};

bool adjoins(const MapCurb& run, const MapCurb& piece, double gap_m) {
  if (piece.kind != run.kind || std::abs(piece.height_m - run.height_m) > like_height_m) return false;
  const Axis axis(run);
  const Beside a = axis.beside(piece.x0_m, piece.y0_m), b = axis.beside(piece.x1_m, piece.y1_m);
  return std::max(std::abs(a.across_m), std::abs(b.across_m)) <= gap_m && std::max(a.along_m, b.along_m) >= -gap_m &&
         std::min(a.along_m, b.along_m) <= axis.length() + gap_m;
}

/// The run extended by the piece: between the two of the four ends that are furthest apart along the run.
MapCurb extended(const MapCurb& run, const MapCurb& piece) {
  const Axis axis(run);
  MapCurb result = run;
  double first_m = 0, last_m = axis.length();
  for (const auto& [x, y] : {std::pair{piece.x0_m, piece.y0_m}, std::pair{piece.x1_m, piece.y1_m}}) {
    const double along_m = axis.beside(x, y).along_m;
    if (along_m < first_m) first_m = along_m, result.x0_m = x, result.y0_m = y;
    if (along_m > last_m) last_m = along_m, result.x1_m = x, result.y1_m = y;
  }
  const double share = length_m(piece) / std::max(length_m(run) + length_m(piece), 1e-9);
  result.height_m += share * (piece.height_m - run.height_m);
  return result;
}

bool longer(const MapCurb& a, const MapCurb& b) {
  return length_m(a) > length_m(b);
}

bool is_finite(const MapCurb& curb) {
  return std::isfinite(curb.x0_m + curb.y0_m + curb.x1_m + curb.y1_m + curb.height_m);
}

std::string centimetres(double height_m) {
  const double rounded = std::round(100 * height_m);
  char words[32];
  std::snprintf(words, sizeof words, "%+.0f cm", rounded);
  return rounded == 0 ? "" : words;
}

constexpr double shares[] = {0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.1, 0.9};

/// A box that touches the line at `share` of its length on one side (1) or the other (-1), or lies on it (0).
Box beside_line(Pixel a, Pixel b, double share, double side, double width) {
  const double height = text_height + 4, length = std::hypot(b.x - a.x, b.y - a.y);
  const double nx = side * -(b.y - a.y) / length, ny = side * (b.x - a.x) / length;
  const double away = 0.5 * (std::abs(nx) * width + std::abs(ny) * height) + 6;
  const double x = a.x + share * (b.x - a.x) + away * nx, y = a.y + share * (b.y - a.y) + away * ny;
  return {x - 0.5 * width, y - 0.5 * height, width, height};
}

}  // namespace

std::vector<MapCurb> joined(std::span<const MapCurb> curbs, double gap_m) {
  std::vector<MapCurb> left, result;
  std::copy_if(curbs.begin(), curbs.end(), std::back_inserter(left), is_finite);
  std::stable_sort(left.begin(), left.end(), longer);
  while (!left.empty()) {
    MapCurb run = left.front();
    left.erase(left.begin());
    const auto next = [&] {
      return std::find_if(left.begin(), left.end(), [&](const MapCurb& piece) { return adjoins(run, piece, gap_m); });
    };
    for (auto piece = next(); piece != left.end(); piece = next()) {
      run = extended(run, *piece);
      left.erase(piece);
    }
    result.push_back(run);
  }
  std::stable_sort(result.begin(), result.end(), longer);
  return result;
}

std::vector<PlacedText> place_heights(std::span<const MapCurb> pieces, std::span<const MapCurb> curbs, const View& view,
                                      std::vector<Box> taken, const TextWidth& width) {
  const auto place = [&](const MapCurb& piece, double text_width) -> std::optional<Box> {
    const Pixel a = view.at(piece.x0_m, piece.y0_m), b = view.at(piece.x1_m, piece.y1_m);
    if (std::hypot(b.x - a.x, b.y - a.y) < shortest) return std::nullopt;
    for (const double share : shares) {
      for (const double side : {1.0, -1.0}) {
        const Box box = beside_line(a, b, share, side, text_width);
        if (is_free(box, view, taken, curbs)) return box;
      }
    }
    if (std::hypot(b.x - a.x, b.y - a.y) < 3 * text_width) return std::nullopt;
    for (const double share : shares) {
      const Box box = beside_line(a, b, share, 0, text_width);
      if (is_free(box, view, taken, {})) return box;
    }
    return std::nullopt;
  };
  std::vector<PlacedText> result;
  for (const MapCurb& piece : pieces) {
    const std::string words = centimetres(piece.height_m);
    if (words.empty()) continue;
    const std::optional<Box> box = place(piece, width(words) + 4);
    if (!box) continue;
    taken.push_back(*box);
    result.push_back({words, *box});
  }
  return result;
}

bool is_free(const Box& box, const View& view, std::span<const Box> taken, std::span<const MapCurb> curbs) {
  const auto meets = [&](const Box& other) { return overlap(box, other); };
  const auto crossed = [&](const MapCurb& curb) {
    return crosses(box, view.at(curb.x0_m, curb.y0_m), view.at(curb.x1_m, curb.y1_m));
  };
  return inside(box, view.box) && std::none_of(taken.begin(), taken.end(), meets) &&
         std::none_of(curbs.begin(), curbs.end(), crossed);
}

}  // namespace curbline::tools::picture
