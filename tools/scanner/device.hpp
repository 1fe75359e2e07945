// The scanner's side of a protocol: commands in, replies and scan telegrams out. Pure. Each answers what a real one
// answers on the way to scan lines, and refuses the rest as a real one does.
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

  /// As it is when its power comes on. What it says then.
  virtual Bytes power_on() = 0;

  /// Replies to the commands that these bytes complete. `clock_ns` is the scanner's time.
  virtual Bytes take(std::span<const std::uint8_t> bytes, std::int64_t clock_ns) = 0;

  /// True if it sends every scan.
  virtual bool measuring() const = 0;

  /// A scan line on the wire. Its stamp is the line's time, modulo the width of the counter.
  virtual Bytes telegram(const CarmenLine& scan) = 0;

  /// From the first to the last beam.
  virtual std::int64_t line_duration_ns() const = 0;

  /// Of a serial line; 0: it has none. It sends a scan when the one before has left.
  virtual int baud() const { return 0; }
};

// `scan` tells the geometry. They throw BadInput, naming `source`, if the scanner has none like it.
std::unique_ptr<Device> make_scip2_device(const CarmenLine& scan, const std::string& source);  ///< UTM-30LX
std::unique_ptr<Device> make_cola_device(const CarmenLine& scan, const std::string& source);   ///< LMS151
std::unique_ptr<Device> make_lms200_device(const CarmenLine& scan, const std::string& source,
                                           int baud = 500'000);  ///< LMS200

}  // namespace curbline::tools
