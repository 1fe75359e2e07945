// Parts of text for code that runs on boards too. std::string_view::substr() throws where the part begins beyond the
// end; a compiler that cannot see that it never does links what throws, and with it the heap, into a firmware.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace curbline::port {

/// At most `count` characters from `from` on; empty beyond the end.
constexpr std::string_view part(std::string_view text, std::size_t from, std::size_t count = std::string_view::npos) {
  from = std::min(from, text.size());
  return {text.data() + from, std::min(count, text.size() - from)};
}

}  // namespace curbline::port
