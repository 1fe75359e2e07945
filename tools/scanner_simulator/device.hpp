// The scanner's side of a protocol: commands in, replies and scan telegrams out. No I/O. Each device answers the
// commands on the way to scan lines as a real scanner does, and refuses the others in the same way.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/carmen.hpp"

namespace curbline::tools {

using Bytes = std::vector<std::uint8_t>;

class Device {
 public:
  virtual ~Device() = default;

  /// Resets to the state after power-on. Returns what the scanner sends then.
  virtual Bytes power_on() = 0;

  /// Replies to the commands that these bytes complete. `clock_ns` is the scanner's time.
  virtual Bytes take(std::span<const std::uint8_t> bytes, std::int64_t clock_ns) = 0;

  /// True while it sends every scan.
  virtual bool measuring() const = 0;

  /// The telegram of a scan line. Its stamp is the line's time, modulo the width of the counter.
  virtual Bytes telegram(const CarmenLine& scan) = 0;

  /// From the first to the last beam.
  virtual std::int64_t line_duration_ns() const = 0;

  /// Bits a second of a serial line; 0: not serial. A scan is sent when the previous one has been transmitted.
  virtual int baud() const { return 0; }
};

// `scan` defines the geometry. They throw BadInput, naming `source`, if the scanner does not have this geometry.
std::unique_ptr<Device> make_scip2_device(const CarmenLine& scan, const std::string& source);  ///< UTM-30LX
std::unique_ptr<Device> make_cola_device(const CarmenLine& scan, const std::string& source);   ///< LMS151
std::unique_ptr<Device> make_lms200_device(const CarmenLine& scan, const std::string& source,
                                           int baud = 500'000);  ///< LMS200

}  // namespace curbline::tools
