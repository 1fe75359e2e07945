// The fields of one line of text, read from left to right. Each is named as it is read, so that what is missing or
// wrong is said with the file, the line, the field and what was expected. Numbers by std::from_chars: no locale, about
// 50 ns.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "formats/line_reader.hpp"

namespace curbline::tools {

/// Are they seconds that 64 bits of nanoseconds can hold?
inline bool is_time_s(double seconds) {
  return seconds >= 0.0 && seconds < 9.2e9;
}

/// A time in seconds, as nanoseconds: exact if it is written in decimals. Nothing if the text is none. No heap.
std::optional<std::int64_t> parse_time_ns(std::string_view text);

class Fields {
 public:
  /// How fields are apart: by any run of blanks and tabs, or by one comma each, blanks about it ignored.
  enum class Apart { blanks, commas };

  /// `source` must have given `line`, and outlive this.
  Fields(const LineReader& source, std::string_view line, Apart apart = Apart::blanks);

  /// True if no field is left. Blank lines start that way.
  bool at_end() const { return !more_; }

  // Each takes the next field. They throw BadInput if there is none or it is another thing.
  std::string_view word(std::string_view name);
  double number(std::string_view name);         ///< finite
  double number_or_nan(std::string_view name);  ///< NaN and infinities too
  std::int64_t whole(std::string_view name, std::int64_t lowest, std::int64_t highest);
  std::int64_t time_ns(std::string_view name);  ///< seconds; exact to the nanosecond if written in decimals

  /// Throws BadInput if a field is left.
  void expect_end() const;

  [[noreturn]] void fail(std::string_view name, std::string_view got, const std::string& expected) const;

 private:
  double read_number(std::string_view name, std::string_view field) const;

  const LineReader& source_;
  std::string_view rest_;  ///< from the next field on
  Apart apart_;
  bool more_;
};

}  // namespace curbline::tools
