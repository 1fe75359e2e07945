// The published method (Maye, Kaestner and Siegwart, ICRA 2012) as a batch in double precision, for comparison with the
// streaming pipeline. Cells, graph segmentation, least squares, EM with beliefs from loopy belief propagation. Where
// the paper's text and its code differ, this follows the code (each file says where); eq. (10) is optional.
//
// Departures from the code. On the recorded streets, each of the first two changes the V-measure by less than 0.01:
// - The M-step weights cells by their responsibility, as in the paper's formula; the code by its square.
// - A component of three cells gets a plane, one whose cells lie on one line a level plane; the code requires four
//   cells that determine both slopes.
// - EM stops when the likelihood of independent cells converges; the code uses belief propagation's own estimate.
// - Planes have a minimum variance, node potentials are scaled by their largest: the code can overflow or underflow.
// - The code drops cells some 38 standard deviations from the mean height; here the limit on height does that.
#pragma once

#include <span>

#include "map/map.hpp"

namespace curbline::tools::reference {

enum class Method {
  segment,  ///< only the graph segmentation
  em,       ///< then EM for a mixture of planes, cells independent
  crf_em,   ///< the E-step by belief propagation on the grid: the paper's algorithm
};

enum class EdgePotential {
  potts,  ///< the constant factor of the paper's code: exp(potts) for equal labels, 1 otherwise
  eq10,   ///< the paper's eq. (10), from the cells' heights and variances
};

/// How a message is computed; the results only differ by rounding.
enum class Messages {
  general,     ///< by the K x K matrix of the edge, as in a general engine for factor graphs: O(K^2)
  two_valued,  ///< from the sum of the sender's belief: O(K)
};

struct Options {
  Method method = Method::crf_em;
  EdgePotential edge = EdgePotential::potts;
  double potts = 10;
  double segment_scale = 100;  ///< s of Felzenszwalb and Huttenlocher
  double max_height_m = 1e9;   ///< points above it are ignored
  Messages messages = Messages::two_valued;
};

/// The most cells times planes of em and crf_em, which keep 3 and 8 doubles for each. At the bound they take 0.8
/// and 2.1 GB, and minutes. In 512 x 512 cells a street of 2 million points has 112 planes at first, and is within it;
/// noise of 200,000 points has 7,000, and would take 24 and 62 GB.
inline constexpr std::size_t most_cells_times_planes = 1 << 25;

/// Labels are numbered by the size of their component, the largest first. O(EM steps x BP sweeps x cells x K) or K^2.
/// Throws BadInput beyond most_cells_times_planes.
Map map_cloud(std::span<const Point3> cloud, const Grid& grid, const Options& options);

}  // namespace curbline::tools::reference
