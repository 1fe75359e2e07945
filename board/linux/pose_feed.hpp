// Poses of a moving robot, T_map_base, as its localisation writes them: lines of a TUM trajectory, `time tx ty tz qx qy
// qz qw`, through a FIFO or standard input. Nothing in it waits or allocates memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "curbline/pose.hpp"

namespace curbline::daemon {

class PoseFeed {
 public:
  PoseFeed() = default;
  ~PoseFeed();
  PoseFeed(const PoseFeed&) = delete;
  PoseFeed& operator=(const PoseFeed&) = delete;

  /// The path of a FIFO, whose writers may connect and disconnect, or "-". Throws BadInput.
  void open(const std::string& source);

  /// For poll(2), POLLIN; -1 before open() and after the end of standard input.
  int descriptor() const { return descriptor_; }

  /// The next received pose; nothing if there are no more. Empty lines and # comments are skipped.
  std::optional<Pose> next();

  std::uint64_t damaged() const { return damaged_; }  ///< lines that are not poses, skipped

 private:
  bool fill();
  void close();
  std::optional<std::string_view> next_line();

  int descriptor_ = -1;
  std::array<char, 4096> buffer_{};
  std::size_t begin_ = 0, end_ = 0;  ///< the bytes read and not yet returned
  bool skipping_ = false;            ///< skipping the rest of a line that exceeds the buffer
  std::uint64_t damaged_ = 0;
};

}  // namespace curbline::daemon
