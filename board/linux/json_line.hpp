// A JSON object on one line, written into memory of fixed size: no heap, no locale. What does not fit is left out from
// the last mark on, so that a line is always complete JSON.
//
//   JsonLine json(buffer);
//   json.open('{').key("tilt").text("ok").key("curbs").open('[') ... .close(']').close('}').end();
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace curbline::daemon {

class JsonLine {
 public:
  /// The last 16 bytes of the buffer are reserved for the brackets and the line's end after what was left out.
  explicit JsonLine(std::span<char> buffer) : buffer_(buffer) {}

  JsonLine& open(char bracket) {
    separate();
    put({&bracket, 1});
    comma_ = false;
    return *this;
  }
  JsonLine& close(char bracket) {
    put({&bracket, 1}, closing_reserve);
    comma_ = true;
    return *this;
  }
  /// Keys and texts are constants of the program that need no escaping.
  JsonLine& key(std::string_view name) {
    text(name);
    put(":");
    comma_ = false;
    return *this;
  }
  JsonLine& text(std::string_view words) {
    separate();
    put("\"");
    put(words);
    put("\"");
    return *this;
  }
  JsonLine& whole(std::int64_t value) { return number(value); }
  JsonLine& boolean(bool value) {
    separate();
    put(value ? "true" : "false");
    return *this;
  }
  /// Metres, seconds, probabilities: rounded to a millionth, as in curb files.
  JsonLine& real(double value) {
    if (std::isfinite(value)) return number(std::round(value * 1e6) / 1e6);
    separate();
    put("null");
    return *this;
  }
  /// Nanoseconds >= 0 as seconds with six decimals, truncated.
  JsonLine& seconds(std::int64_t time_ns) {
    number(time_ns / 1'000'000'000);
    char fraction[7] = {'.'};
    std::int64_t micros = time_ns / 1000 % 1'000'000;
    for (int i = 6; i > 0; --i, micros /= 10) fraction[i] = static_cast<char>('0' + micros % 10);
    put({fraction, sizeof fraction});
    return *this;
  }

  /// The position to truncate to if what follows does not fit.
  struct Mark {
    std::size_t size;
    bool comma;
  };
  Mark mark() const { return {size_, comma_}; }
  bool full() const { return full_; }
  void cut(const Mark& at) {
    size_ = at.size;
    comma_ = at.comma;
    full_ = false;
  }

  std::string_view end() {
    put("\n", closing_reserve);
    return {buffer_.data(), size_};
  }

 private:
  static constexpr std::size_t closing_reserve = 16;

  void separate() {
    if (comma_) put(",");
    comma_ = true;
  }
  void put(std::string_view text, std::size_t from_reserve = 0) {
    if (size_ + text.size() > buffer_.size() - closing_reserve + from_reserve) {
      full_ = true;
      return;
    }
    std::memcpy(buffer_.data() + size_, text.data(), text.size());
    size_ += text.size();
  }
  template <typename Number>
  JsonLine& number(Number value) {
    separate();
    char digits[32];
    std::to_chars_result result{};
    if constexpr (std::is_integral_v<Number>) {
      result = std::to_chars(digits, digits + sizeof digits, value);
    } else {
      result = std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed);
    }
    if (result.ec == std::errc{}) {
      put({digits, static_cast<std::size_t>(result.ptr - digits)});
    } else {
      put("null");  // beyond 1e25
    }
    return *this;
  }

  std::span<char> buffer_;
  std::size_t size_ = 0;
  bool comma_ = false, full_ = false;
};

}  // namespace curbline::daemon
