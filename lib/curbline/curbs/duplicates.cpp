#include "curbline/curbs/duplicates.hpp"

#include <algorithm>
#include <cstddef>

namespace curbline {

void find_duplicates(std::span<const Curb> curbs, float cell_m, std::span<bool> is_duplicate) {
  for (std::size_t k = 0; k < curbs.size(); ++k) {
    const float length_m = length_of(curbs[k]), least_m = length_m - std::min(length_m, cell_m);
    const bool brink = curbs[k].far_label == no_label;
    is_duplicate[k] = false;
    for (std::size_t o = 0; is_step(curbs[k]) && o < curbs.size() && !is_duplicate[k]; ++o) {
      const float other_m = length_of(curbs[o]);
      const bool longer = other_m > length_m || (other_m == length_m && o < k);
      const bool stands_for_it = (curbs[o].far_label == no_label) == brink ? longer : brink;
      is_duplicate[k] = stands_for_it && is_step(curbs[o]) && overlap_m(curbs[k], curbs[o], cell_m) > least_m;
    }
  }
}

}  // namespace curbline
