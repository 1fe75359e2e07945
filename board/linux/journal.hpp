// The daemon's messages to its user on standard error, which systemd's journal reads: one line per event, in memory of
// fixed size, and a continuing trouble only once.
#pragma once

#include <array>
#include <charconv>
#include <concepts>
#include <cstdint>
#include <string_view>

namespace curbline::daemon {

/// A line made of words and whole numbers, truncated to 400 bytes.
class JournalLine {
 public:
  JournalLine& operator<<(std::string_view words) {
    for (const char c : words.substr(0, text_.size() - 1 - size_)) text_[size_++] = c;
    return *this;
  }
  template <std::integral Number>
  JournalLine& operator<<(Number value) {
    std::array<char, 24> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    return *this << std::string_view(digits.data(), static_cast<std::size_t>(end - digits.data()));
  }
  std::string_view text() const { return {text_.data(), size_}; }
  /// Writes it to standard error; dropped if there is no room, without waiting.
  void say();

 private:
  std::array<char, 400> text_{};
  std::size_t size_ = 0;
};

template <typename... Parts>
void say(const Parts&... parts) {
  JournalLine line;
  line << "curblined: ";
  (line << ... << parts).say();
}

/// A kind of trouble with a counter: it is news when it begins, and again only after 10 s without an occurrence.
class Trouble {
 public:
  bool is_news(std::uint64_t count, std::int64_t now_ns) {
    if (count == seen_) return false;
    const bool begins = seen_ == 0 || now_ns - last_ns_ > absence_ns;
    seen_ = count;
    last_ns_ = now_ns;
    return begins;
  }

 private:
  static constexpr std::int64_t absence_ns = 10'000'000'000;
  std::uint64_t seen_ = 0;
  std::int64_t last_ns_ = 0;
};

}  // namespace curbline::daemon
