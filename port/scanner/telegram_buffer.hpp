// Extracts complete telegrams from a stream of bytes that may be damaged. `Format` defines the header, the size and the
// checksum of a telegram. If a check fails, only the first byte is discarded, so that a telegram that follows a
// truncated one is found among the bytes held. Static memory; each byte is copied once; the check is repeated for each
// header found within a damaged telegram.
//
//   struct Format {
//     static constexpr std::size_t header;                            bytes needed to determine the size
//     static std::size_t size_of(std::span<const std::uint8_t>);      of the telegram with this header, 0: not a header
//     static bool plausible(std::span<const std::uint8_t>);           its size is one that the device sends
//     static bool check(std::span<const std::uint8_t>);               checksum of the whole telegram
//     static bool filler(std::uint8_t);                               may lie between telegrams
//   };
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "scanner/session.hpp"

namespace curbline::scanner {

template <typename Format, std::size_t capacity>
class TelegramBuffer {
 public:
  explicit TelegramBuffer(Counters& counters) : counters_(counters) {}

  void restart() { begin_ = end_ = damaged_end_ = 0; }

  /// The next telegram, valid until the next call; empty when all bytes were used. Removes the bytes used from the
  /// front.
  std::span<const std::uint8_t> take(std::span<const std::uint8_t>& bytes) {
    while (true) {
      if (const auto telegram = next(); !telegram.empty()) return telegram;
      if (bytes.empty()) return {};
      make_room();
      const std::size_t count = std::min(bytes.size(), held_.size() - end_);
      std::copy_n(bytes.begin(), count, held_.begin() + static_cast<std::ptrdiff_t>(end_));
      end_ += count;
      bytes = bytes.subspan(count);
    }
  }

 private:
  std::span<const std::uint8_t> next() {
    while (end_ - begin_ >= Format::header) {
      const auto held = std::span<const std::uint8_t>(held_).subspan(begin_, end_ - begin_);
      const std::size_t size = Format::size_of(held);
      if (size == 0) {
        skip();
        continue;
      }
      if (size > capacity || !Format::plausible(held)) {
        ++counters_.wrong_length;
        skip();
        continue;
      }
      if (held.size() < size) return {};
      if (!Format::check(held.first(size))) {
        ++counters_.bad_checksum;
        damaged_end_ = std::max(damaged_end_, begin_ + size);
        skip();
        continue;
      }
      counters_.cut += begin_ < damaged_end_;  // it began before the damaged telegram should have ended
      damaged_end_ = 0;
      begin_ += size;
      return held.first(size);
    }
    return {};
  }

  void skip() {
    counters_.bytes_skipped += !Format::filler(held_[begin_]);
    ++begin_;
  }

  /// A telegram fits into `capacity`, so there is always room for the rest of one.
  void make_room() {
    if (begin_ == 0) return;
    std::copy(held_.begin() + static_cast<std::ptrdiff_t>(begin_), held_.begin() + static_cast<std::ptrdiff_t>(end_),
              held_.begin());
    damaged_end_ -= std::min(damaged_end_, begin_);
    end_ -= begin_;
    begin_ = 0;
  }

  Counters& counters_;
  std::array<std::uint8_t, capacity> held_{};
  std::size_t begin_ = 0, end_ = 0;
  std::size_t damaged_end_ = 0;
};

}  // namespace curbline::scanner
