#include "lms200/scan_data.hpp"

#include <limits>

namespace curbline::lms200 {
namespace {

constexpr std::uint16_t count_mask = 0x03FF, partial_flag = 0x2000;
constexpr int error_numbers = 9;  // 8183 to 8191 with 13 bits

std::uint16_t u16(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
}

}  // namespace

ScanResult parse_scan_data(std::span<const std::uint8_t> content, int range_bits, std::span<float, most_beams> ranges_m,
                           std::size_t& count) {
  if (content.size() < 4) return ScanResult::wrong_length;
  const std::uint16_t info = u16(content, 1);
  if ((info & partial_flag) != 0) return ScanResult::partial;
  const int unit = info >> 14;
  if (unit > 1) return ScanResult::other_unit;
  count = info & count_mask;
  if (variant_of(count).field_deg == 0 || content.size() != 3 + 2 * count + 1) return ScanResult::wrong_length;
  const double units_a_metre = unit == 1 ? 1000.0 : 100.0;
  const int mask = (1 << range_bits) - 1;
  for (std::size_t i = 0; i < count; ++i) {
    const int value = u16(content, 3 + 2 * i) & mask;
    const bool is_return = value <= mask - error_numbers;
    ranges_m[i] = is_return ? static_cast<float>(value / units_a_metre) : std::numeric_limits<float>::quiet_NaN();
  }
  return ScanResult::ok;
}

}  // namespace curbline::lms200
