// The fields of one line of text, read from left to right. Each is named when it is read, so that an error states the
// file, the line, the field and what was expected. Numbers are read with std::from_chars: no locale, about 50 ns.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "formats/line_reader.hpp"

namespace curbline::tools {

/// 291 years after 1970. Whoever adds some seconds to such a time stays within 64 bits.
inline constexpr std::int64_t latest_ns = 9'200'000'000'000'000'000;

/// Whether nanoseconds up to the latest can represent these seconds.
inline bool is_time_s(double seconds) {
  return seconds >= 0.0 && seconds <= 1e-9 * static_cast<double>(latest_ns);
}

/// A time in seconds, converted to nanoseconds: exact if it is written in decimals. Nothing if the text is not a time,
/// or one after the latest. No heap.
std::optional<std::int64_t> parse_time_ns(std::string_view text);

class Fields {
 public:
  /// How fields are separated: by any run of blanks and tabs, or by one comma each, with blanks around it ignored.
  enum class Apart { blanks, commas };

  /// `line` must have been read from `source`, which must outlive this object.
  Fields(const LineReader& source, std::string_view line, Apart apart = Apart::blanks);

  /// True if no field is left, as from the start on a blank line.
  bool at_end() const { return !more_; }

  // Each reads the next field and throws BadInput if there is none or it has another form.
  std::string_view word(std::string_view name);
  double number(std::string_view name);         ///< finite
  double number_or_nan(std::string_view name);  ///< also accepts NaN and infinities
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
