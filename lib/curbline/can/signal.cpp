#include "curbline/can/signal.hpp"

#include <bit>
#include <cmath>
#include <limits>

namespace curbline::can {
namespace {

/// The bits of a number: the part that a signal and a multiplexor have in common.
struct Bits {
  int start, length;
  ByteOrder order;
};

constexpr Bits bits_of(const Signal& s) {
  return {s.start_bit, s.length, s.order};
}
constexpr Bits bits_of(const Multiplexor& m) {
  return {m.start_bit, m.length, m.order};
}

/// The bit below in significance, in the numbering of Signal::start_bit.
constexpr int next_lower(ByteOrder order, int bit) {
  if (order == ByteOrder::little) return bit - 1;
  return bit % 8 == 0 ? bit + 15 : bit - 1;
}

constexpr int most_significant(const Bits& b) {
  return b.order == ByteOrder::little ? b.start + b.length - 1 : b.start;
}

/// Bytes that a frame must have.
constexpr int bytes_of(const Bits& b) {
  if (b.order == ByteOrder::little) return most_significant(b) / 8 + 1;
  const int before_start = b.start / 8 * 8 + (7 - b.start % 8);  // bits sent before the first of the number
  return (before_start + b.length - 1) / 8 + 1;
}

constexpr bool fits_a_frame(const Bits& b) {
  return b.length >= 1 && b.length <= 64 && bytes_of(b) <= 64;
}

std::uint64_t read_bits(const Bits& b, const Frame& frame) {
  std::uint64_t raw = 0;
  int bit = most_significant(b);
  for (int i = 0; i < b.length; ++i, bit = next_lower(b.order, bit)) {
    const unsigned byte = frame.data[static_cast<std::size_t>(bit / 8)];
    raw = raw << 1 | (byte >> (bit % 8) & 1u);
  }
  return raw;
}

void write_bits(const Bits& b, std::uint64_t raw, Frame& frame) {
  int bit = most_significant(b);
  for (int i = b.length - 1; i >= 0; --i, bit = next_lower(b.order, bit)) {
    std::uint8_t& byte = frame.data[static_cast<std::size_t>(bit / 8)];
    const unsigned mask = 1u << (bit % 8);
    byte = static_cast<std::uint8_t>((raw >> i & 1u) != 0 ? byte | mask : byte & ~mask);
  }
}

/// high 2^32 + low, rounded once. Converting 64 bits at once would link soft-float on a 32-bit core, whatever its FPU,
/// with its additions: 800 bytes of flash.
double joined(double high, std::uint64_t low) {
  return high * 0x1p32 + static_cast<double>(static_cast<std::uint32_t>(low));
}

double raw_to_number(const Signal& s, std::uint64_t raw) {
  if (s.is_float) return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
  if (!s.is_signed) return joined(static_cast<double>(static_cast<std::uint32_t>(raw >> 32)), raw);
  const int unused = 64 - s.length;
  const auto value =
      static_cast<std::uint64_t>(static_cast<std::int64_t>(raw << unused) >> unused);  // C++20: >> keeps the sign
  return joined(static_cast<double>(static_cast<std::int32_t>(value >> 32)), value);
}

/// Nearest integer, halves away from 0. |x| < 2^63 or 0 <= x < 2^64 by the type.
template <typename Integer>
Integer round_to(double x) {
  const auto whole = static_cast<Integer>(x);
  const double rest = x - static_cast<double>(whole);
  if (rest >= 0.5) return whole + 1;
  if (rest <= -0.5) return whole - 1;
  return whole;
}

/// 2^n without libm.
constexpr double power_of_2(int n) {
  return n == 64 ? 0x1p64 : static_cast<double>(std::uint64_t{1} << n);
}

std::uint64_t number_to_raw(const Signal& s, double count) {
  if (s.is_float) {
    constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
    const double in_range = !(count > -most) ? -most : count < most ? count : most;
    return std::bit_cast<std::uint32_t>(static_cast<float>(in_range));
  }
  const int magnitude_bits = s.is_signed ? s.length - 1 : s.length;
  const std::uint64_t all_ones = ~std::uint64_t{0} >> (64 - s.length);
  const std::uint64_t highest = s.is_signed ? all_ones >> 1 : all_ones;
  const std::uint64_t lowest = s.is_signed ? highest + 1 : 0;  // two's complement
  const double end = power_of_2(magnitude_bits);
  if (!(count > (s.is_signed ? -end : 0.0))) return lowest;
  if (count >= end - 0.5) return highest;
  return s.is_signed ? static_cast<std::uint64_t>(round_to<std::int64_t>(count)) : round_to<std::uint64_t>(count);
}

}  // namespace

bool valid(const Signal& s) {
  if (!fits_a_frame(bits_of(s)) || (s.is_float && s.length != 32)) return false;
  if (s.id > highest_id(s.extended)) return false;
  if (s.multiplexor) {
    const Bits bits = bits_of(*s.multiplexor);
    if (!fits_a_frame(bits) || (bits.length < 64 && s.multiplexor->value >> bits.length != 0)) return false;
  }
  if (s.max_bytes > 64 || s.min_bytes > s.max_bytes || bytes_needed(s) > s.max_bytes) return false;
  return std::isfinite(s.scale) && s.scale != 0.0 && std::isfinite(s.offset);
}

int bytes_needed(const Signal& s) {
  const int own = bytes_of(bits_of(s)), selector = s.multiplexor ? bytes_of(bits_of(*s.multiplexor)) : 0;
  const int longer = own > selector ? own : selector;
  return fd_length(static_cast<std::uint8_t>(longer > s.min_bytes ? longer : s.min_bytes));
}

bool carries(const Signal& signal, const Frame& frame) {
  if (frame.extended != signal.extended || frame.remote || frame.error) return false;
  if (((frame.id ^ signal.id) & signal.id_mask) != 0 || frame.length > signal.max_bytes) return false;
  if (!signal.multiplexor) return true;
  const Bits selector = bits_of(*signal.multiplexor);
  return frame.length < bytes_of(selector) || read_bits(selector, frame) == signal.multiplexor->value;
}

std::optional<double> decode(const Signal& signal, const Frame& frame) {
  if (!carries(signal, frame) || frame.length < bytes_needed(signal)) return std::nullopt;
  const double value = raw_to_number(signal, read_bits(bits_of(signal), frame)) * signal.scale + signal.offset;
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

void encode(const Signal& signal, double value, Frame& frame) {
  frame.id = signal.id;
  frame.extended = signal.extended;
  frame.remote = frame.error = false;
  const auto needed = static_cast<std::uint8_t>(bytes_needed(signal));
  if (needed > 8) frame.fd = true;
  if (needed > frame.length) frame.length = needed;
  if (signal.multiplexor) write_bits(bits_of(*signal.multiplexor), signal.multiplexor->value, frame);
  write_bits(bits_of(signal), number_to_raw(signal, (value - signal.offset) / signal.scale), frame);
}

}  // namespace curbline::can
