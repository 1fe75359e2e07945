// Steps that were found twice: cells crossed by an edge may belong to a third plane, which makes a second step, of
// another height, within a cell of the first. A step along another for all but a cell of its own length is a duplicate
// if it is a brink and the other none, or if both or neither are and it is the shorter one (of equals the second).
#pragma once

#include <span>

#include "curbline/curbs/curb.hpp"

namespace curbline {

/// Sets for each curb whether it is a duplicate. O(curbs^2).
void find_duplicates(std::span<const Curb> curbs, float cell_m, std::span<bool> is_duplicate);

}  // namespace curbline
