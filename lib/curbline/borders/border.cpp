#include "curbline/borders/border.hpp"

namespace curbline {

ChainPart::ChainPart(const Border* all, std::span<const Border::Index> part, Ends of_chain)
    : ends(of_chain), all_(all), part_(part) {
  int open = 0;
  for (const Border& border : *this) open += border.open;
  if (open > 0 && open < size()) open_share_ = 1.0f / static_cast<float>(open);
  for (const Border& border : *this) observations_ += share(border);
}

}  // namespace curbline
