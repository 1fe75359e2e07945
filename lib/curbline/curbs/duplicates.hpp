// Steps that were found twice. Cells crossed by an edge may belong to a third plane, which makes a second step, of
// another height, within a cell of the first. Of two steps along each other (all but a cell of the shorter one) the
// longer stands for the edge, of equals the first; the other is a duplicate. A function without state.
#pragma once

#include <span>

#include "curbline/curbs/curb.hpp"

namespace curbline {

/// Sets for each curb whether it is a duplicate. O(curbs^2).
void find_duplicates(std::span<const Curb> curbs, float cell_m, std::span<bool> is_duplicate);

}  // namespace curbline
