#include "formats/fields.hpp"

#include <algorithm>
#include <cmath>

#include "candump/candump.hpp"
#include "formats/ascii.hpp"
#include "formats/parse_number.hpp"

namespace curbline::tools {
namespace {

constexpr std::string_view blanks = " \t";

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// The part of a field that is shown in the one line of an error.
std::string shown(std::string_view text) {
  constexpr std::size_t most = 40;
  return printable_ascii(text.substr(0, most)) + (text.size() > most ? "..." : "");
}

}  // namespace

std::optional<std::int64_t> parse_time_ns(std::string_view text) {
  if (const auto exact = candump::parse_time(text)) return *exact <= latest_ns ? exact : std::nullopt;
  // With an exponent, as numerical tools write it: as accurate as a double, 0.2 us in this century.
  const auto seconds = parse_number<double>(text);
  if (!seconds || !is_time_s(*seconds)) return std::nullopt;
  const double whole = std::floor(*seconds);
  return static_cast<std::int64_t>(whole) * 1'000'000'000 + std::llround((*seconds - whole) * 1e9);
}

Fields::Fields(const LineReader& source, std::string_view line, Apart apart)
    : source_(source), rest_(trim(line)), apart_(apart), more_(!rest_.empty()) {}

std::string_view Fields::word(std::string_view name) {
  if (!more_) source_.fail("the line ends before " + std::string(name) + "; expected one field more");
  const std::size_t end = apart_ == Apart::commas ? rest_.find(',') : rest_.find_first_of(blanks);
  const std::string_view field = rest_.substr(0, end);
  if (end == std::string_view::npos) {
    more_ = false;
    rest_ = {};
  } else {
    rest_.remove_prefix(end + 1);
    rest_.remove_prefix(std::min(rest_.find_first_not_of(blanks), rest_.size()));
  }
  return apart_ == Apart::commas ? trim(field) : field;
}

double Fields::read_number(std::string_view name, std::string_view field) const {
  const auto value = parse_number<double>(field);
  if (!value) fail(name, field, "a number");
  return *value;
}

double Fields::number_or_nan(std::string_view name) {
  return read_number(name, word(name));
}

double Fields::number(std::string_view name) {
  const std::string_view field = word(name);
  const double value = read_number(name, field);
  if (!std::isfinite(value)) fail(name, field, "a finite number");
  return value;
}

std::int64_t Fields::whole(std::string_view name, std::int64_t lowest, std::int64_t highest) {
  const std::string_view field = word(name);
  const auto value = parse_number<std::int64_t>(field);
  if (!value || *value < lowest || *value > highest) {
    fail(name, field, "a whole number from " + std::to_string(lowest) + " to " + std::to_string(highest));
  }
  return *value;
}

std::int64_t Fields::time_ns(std::string_view name) {
  const std::string_view field = word(name);
  const auto time_ns = parse_time_ns(field);
  if (!time_ns) fail(name, field, "a time in seconds");
  return *time_ns;
}

void Fields::expect_end() const {
  if (more_) source_.fail("more fields, from \"" + shown(rest_) + "\" on; expected the line to end before");
}

void Fields::fail(std::string_view name, std::string_view got, const std::string& expected) const {
  source_.fail(std::string(name) + " is \"" + shown(got) + "\"; expected " + expected);
}

}  // namespace curbline::tools
