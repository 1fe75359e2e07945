// How a CAN controller divides its clock into bits: quanta before and after the sample point.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace curbline::xilinx_can {

/// A bit is 1 + segment1 + segment2 quanta of `prescaler` clocks; it is sampled after segment1.
struct BitTiming {
  int prescaler = 1;
  int segment1 = 6, segment2 = 1;
  int jump = 1;  ///< quanta by which a bit may be stretched or cut to follow the sender
};

/// The timing that gives exactly this rate and samples nearest to 7/8 of the bit, as CiA 301 recommends; of several,
/// the one with the most quanta. Nothing if the clock cannot be divided within these limits: prescaler to 256, segments
/// to 16 and 8, at least 8 quanta a bit.
constexpr std::optional<BitTiming> bit_timing(std::int64_t clock_hz, std::int64_t bits_s) {
  if (clock_hz <= 0 || bits_s <= 0) return std::nullopt;
  std::optional<BitTiming> best;
  std::int64_t best_error = 0, best_quanta = 1;
  for (int prescaler = 1; prescaler <= 256; ++prescaler) {
    if (clock_hz % (bits_s * prescaler) != 0) continue;
    const std::int64_t quanta = clock_hz / (bits_s * prescaler);
    if (quanta < 8 || quanta > 25) continue;
    const std::int64_t before = std::clamp<std::int64_t>((7 * quanta + 4) / 8, quanta - 8, 17);
    const std::int64_t error = std::max(8 * before - 7 * quanta, 7 * quanta - 8 * before);  // in eighths of a quantum
    if (best && error * best_quanta >= best_error * quanta) continue;                       // relative to the bit
    const int segment2 = static_cast<int>(quanta - before);
    best = BitTiming{prescaler, static_cast<int>(before) - 1, segment2, std::min(segment2, 4)};
    best_error = error;
    best_quanta = quanta;
  }
  return best;
}

}  // namespace curbline::xilinx_can
