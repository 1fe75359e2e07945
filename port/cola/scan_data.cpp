#include "cola/scan_data.hpp"

#include <bit>
#include <cmath>
#include <limits>

#include "cola/telegram.hpp"

namespace curbline::cola {
namespace {

constexpr std::uint16_t first_range = 16;

/// Reads big-endian numbers from the front; past the end it returns 0, and good() is false.
class Numbers {
 public:
  explicit Numbers(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  bool good() const { return good_; }

  std::span<const std::uint8_t> take(std::size_t count) {
    if (count > bytes_.size()) {
      good_ = false;
      bytes_ = {};
      return {};
    }
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }

  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return number(4); }
  double f32() { return static_cast<double>(std::bit_cast<float>(number(4))); }

 private:
  std::uint32_t number(std::size_t size) {
    std::uint32_t value = 0;
    for (const std::uint8_t byte : take(size)) value = value << 8 | byte;
    return value;
  }

  std::span<const std::uint8_t> bytes_;
  bool good_ = true;
};

void read_header(Numbers& in, ScanData& data) {
  in.take(8);  // version, device, serial number
  data.device_status = in.u16();
  in.take(4);  // telegram count, scan count
  data.start_us = in.u32();
  data.transmission_us = in.u32();
  in.take(6);  // inputs, outputs, reserved
  in.take(8);  // frequencies
  const std::uint16_t encoders = in.u16();
  in.take(std::size_t{6} * encoders);
}

ScanResult read_ranges(Numbers& in, double scale, double offset, ScanData& data, std::span<float> ranges_m) {
  data.start_angle_deg = static_cast<std::int32_t>(in.u32()) * 1e-4;
  data.step_deg = in.u16() * 1e-4;
  data.count = in.u16();
  if (data.count > ranges_m.size()) return ScanResult::too_many;
  const auto values = in.take(2 * data.count);
  if (!in.good() || data.count == 0) return ScanResult::malformed;
  for (std::size_t i = 0; i < data.count; ++i) {
    const auto value = static_cast<std::uint16_t>(values[2 * i] << 8 | values[2 * i + 1]);
    const auto range_m = static_cast<float>((value * scale + offset) / 1000.0);
    ranges_m[i] = value < first_range || range_m < 0.0f ? std::numeric_limits<float>::quiet_NaN() : range_m;
  }
  return ScanResult::ok;
}

}  // namespace

ScanResult parse_scan_data(std::span<const std::uint8_t> content, ScanData& data, std::span<float> ranges_m) {
  Numbers in(content);
  read_header(in, data);
  const std::uint16_t channels = in.u16();
  for (std::uint16_t channel = 0; channel < channels && in.good(); ++channel) {
    const auto name = in.take(5);
    const double scale = in.f32(), offset = in.f32();
    if (in.good() && begins(name, "DIST1")) {
      if (!(scale > 0.0 && std::isfinite(scale) && std::isfinite(offset))) return ScanResult::malformed;
      return read_ranges(in, scale, offset, data, ranges_m);
    }
    in.take(6);  // angles
    const std::uint16_t count = in.u16();
    in.take(std::size_t{2} * count);
  }
  return in.good() ? ScanResult::no_dist1 : ScanResult::malformed;
}

}  // namespace curbline::cola
