// The measured values of an LMS2xx, telegram 0xB0: count and unit u16, the values u16, the scanner's status. Pure,
// reentrant. Bits 0 to 9 are the count; bit 13 marks a partial scan (one of the turns of an interlaced scan with finer
// steps), which is refused; bits 14 and 15 are the unit. Source: SICK 8007954, telegrams 30h and B0h.
#pragma once

#include <cstdint>
#include <span>

namespace curbline::lms200 {

inline constexpr std::size_t most_beams = 401;

/// Field of view and step for a number of values. Steps below 1 deg are interlaced: neighbouring beams are 13 ms apart.
struct Variant {
  int field_deg = 0;
  int step_centideg = 0;
};

/// 181 or 361 values: 180 deg in steps of 1 or 0.5; 101, 201, 401: 100 deg in steps of 1, 0.5, 0.25. Others: zeros.
constexpr Variant variant_of(std::size_t values) {
  switch (values) {
    case 181:
      return {180, 100};
    case 361:
      return {180, 50};
    case 101:
      return {100, 100};
    case 201:
      return {100, 50};
    case 401:
      return {100, 25};
    default:
      return {};
  }
}

enum class ScanResult : unsigned char {
  ok,
  wrong_length,  ///< bytes and values do not match, or no scanner has this number of values
  partial,       ///< one turn of an interlaced scan
  other_unit,    ///< neither centimetres nor millimetres
};

/// Reads the content of a telegram 0xB0. `range_bits` is the number of low bits of a value that hold the range, 13 to
/// 16 depending on the measuring mode; the other bits are field flags. Metres; NaN for the nine highest numbers (8183
/// to 8191 with 13 bits), which mean errors and no return.
ScanResult parse_scan_data(std::span<const std::uint8_t> content, int range_bits, std::span<float, most_beams> ranges_m,
                           std::size_t& count);

}  // namespace curbline::lms200
