// Text as a number, for what is not read by CLI11 or toml++. No locale, no heap; about 50 ns.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace curbline::tools {

/// The number that is all of the text, as std::from_chars has it: no blanks, no '+'. Nothing for anything else, and for
/// what the type does not hold.
template <typename Number>
std::optional<Number> parse_number(std::string_view text) {
  const char* const last = text.data() + text.size();
  Number value{};
  const auto [end, problem] = std::from_chars(text.data(), last, value);
  return problem == std::errc{} && end == last ? std::optional(value) : std::nullopt;
}

}  // namespace curbline::tools
