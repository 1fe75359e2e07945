// What is written on the panels: heights beside the curbs and labels on the planes, no text over another. Which texts
// and where is found without drawing.
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

/// Gives the width of a text, pixels.
using TextWidth = std::function<double(const std::string&)>;

/// Pieces of one kind that lie on one line within `gap_m`, adjoin, and differ by at most 2 cm in height, each as one
/// piece with their mean height by length. The longest first. Cost: the square of their number.
std::vector<MapCurb> joined(std::span<const MapCurb> curbs, double gap_m);

/// "+12 cm" for each piece that has a height and a length to be seen, in turn: beside its middle, or elsewhere along
/// it, where the text lies within the panel, clear of `taken` and the texts before it, and across no curb. Where a long
/// piece has no such place, on its line, as on a contour of a map. Else none.
std::vector<PlacedText> place_heights(std::span<const MapCurb> pieces, std::span<const MapCurb> curbs, const View& view,
                                      std::vector<Box> taken, const TextWidth& width);

/// The label of each plane that is larger than its text, on the cell that is nearest to the plane's middle, where that
/// place is free.
std::vector<PlacedText> place_labels(const Map& map, const View& view, std::vector<Box> taken, const TextWidth& width);

/// Whether a text may stand there: within the panel, over nothing taken and across no curb.
bool is_free(const Box& box, const View& view, std::span<const Box> taken, std::span<const MapCurb> curbs);

}  // namespace curbline::tools::picture
