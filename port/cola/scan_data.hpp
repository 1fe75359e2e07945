// Converts the content of an LMDscandata telegram (sRA: requested once, sSN: sent with every scan) to ranges. Pure,
// reentrant, one pass. Source: SICK, Telegram Listing for LMS1xx, 8014631, "LMDscandata".
//
//   version u16, device u16, serial u32, status 2 x u8 | telegrams u16, scans u16, start u32 us, transmission u32 us,
//   inputs 2 x u8, outputs 2 x u8, reserved u16 | scan frequency u32, measurement frequency u32 | encoders u16, each
//   u32 + u16 | 16-bit channels u16, each: name 5 x char, scale f32, offset f32, start angle i32 (1/10000 deg), step
//   u16 (1/10000 deg), count u16, count x u16 | 8-bit channels, position, name, comment, time, event: not read
#pragma once

#include <cstdint>
#include <span>

namespace curbline::cola {

struct ScanData {
  std::uint16_t device_status = 0;    ///< bit 0: fault, bit 1: front screen dirty, bit 2: too dirty to measure
  std::uint32_t start_us = 0;         ///< since power-on: start of the scan
  std::uint32_t transmission_us = 0;  ///< same clock: when the telegram was passed on for transmission
  double start_angle_deg = 0.0;       ///< in the scanner's convention: 90 is ahead, counterclockwise
  double step_deg = 0.0;
  std::size_t count = 0;  ///< number of values
};

enum class ScanResult : unsigned char {
  ok,
  malformed,  ///< the counts do not fit the content, or scale and offset are not those of ranges
  no_dist1,   ///< no channel with distances to the first echo
  too_many,   ///< more values than `ranges_m` holds
};

/// Reads what follows "LMDscandata " into `data` and `ranges_m`: metres, NaN for values below 16, which are error codes
/// (0: no return), and for negative ranges.
ScanResult parse_scan_data(std::span<const std::uint8_t> content, ScanData& data, std::span<float> ranges_m);

}  // namespace curbline::cola
