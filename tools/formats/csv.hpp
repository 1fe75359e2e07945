// Writes labels and curbs, and reads them for scoring.
//   labels  CSV x_m,y_m,height_m,variance_m2,points,label,probability: a row for each valid cell, x y at its centre
//   curbs   CSV x0_m,y0_m,x1_m,y1_m,height_m,height_sd_m,probability,kind: a row for each piece of curb line,
//           or the same names in one JSON object a line
// Metres to 1e-6, variances to 1e-9 m2, probabilities to 1e-6.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "map/map.hpp"

namespace curbline::tools {

/// A row of the label file: a valid cell. The file does not contain the size of the cells.
struct LabelledCell {
  double x_m = 0, y_m = 0;  ///< the cell's centre
  MapCell cell;
};

/// The valid cells of a map, y varying fastest.
std::vector<LabelledCell> labelled_cells(const Map& map);

void write_labels(std::ostream& out, const Map& map);
void write_curbs(std::ostream& out, const std::vector<MapCurb>& curbs);
void write_curb_json(std::ostream& out, const MapCurb& curb);

// Both throw BadInput unless the file has the writers' format, with any number of decimals; also for a position beyond
// 1e8 m and a curb longer than 10 km. A file without rows is valid: nothing was found.
std::vector<LabelledCell> read_labels(const std::string& path);
std::vector<MapCurb> read_curbs(const std::string& path);

}  // namespace curbline::tools
