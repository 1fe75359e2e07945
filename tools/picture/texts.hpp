// The texts on the panels: heights beside the curbs and labels on the planes, without overlaps. Choosing and placing
// them does not draw.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "picture/panel.hpp"

namespace curbline::tools::picture {

struct PlacedText {
  std::string words;
  Box box;
};

/// Returns the width of a text, pixels.
using TextWidth = std::function<double(const std::string&)>;

/// Joins adjacent pieces of one kind that lie on one line within `gap_m` and differ by at most 2 cm in height, to one
/// piece with their mean height, weighted by length. The longest first. Cost: the square of their number.
std::vector<MapCurb> joined(std::span<const MapCurb> curbs, double gap_m);

/// "+12 cm" for each piece with a height and a visible length, in turn. The text is placed beside its middle, or
/// elsewhere along it, inside the panel, clear of `taken` and the texts before it, and not across a curb. A long piece
/// without such a place has it on its line, like a contour of a map. Other pieces have none.
std::vector<PlacedText> place_heights(std::span<const MapCurb> pieces, std::span<const MapCurb> curbs, const View& view,
                                      std::vector<Box> taken, const TextWidth& width);

/// The label of each plane that is larger than its text, on the cell nearest to the plane's middle, if that place is
/// free.
std::vector<PlacedText> place_labels(const Map& map, const View& view, std::vector<Box> taken, const TextWidth& width);

/// Whether a text can be placed there: inside the panel, clear of `taken` and not across a curb.
bool is_free(const Box& box, const View& view, std::span<const Box> taken, std::span<const MapCurb> curbs);

}  // namespace curbline::tools::picture
