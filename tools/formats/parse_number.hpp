// Converts text to a number where CLI11 and toml++ are not used. No locale, no heap; about 50 ns.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace curbline::tools {

/// The number that the whole text represents for std::from_chars: no blanks, no '+'. Nothing for other text, and for
/// values outside the type's range.
template <typename Number>
std::optional<Number> parse_number(std::string_view text) {
  const char* const last = text.data() + text.size();
  Number value{};
  const auto [end, problem] = std::from_chars(text.data(), last, value);
  return problem == std::errc{} && end == last ? std::optional(value) : std::nullopt;
}

}  // namespace curbline::tools
