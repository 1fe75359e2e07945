// Poses of a robot that drives, T_map_base, as whoever localises it writes them: lines of a TUM trajectory, `time tx ty
// tz qx qy qz qw`, through a FIFO or standard input. Nothing in it waits, nothing is taken from the heap.
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

  /// A FIFO's path, whose writers may come and go, or "-". Throws BadInput.
  void open(const std::string& source);

  /// For poll(2), POLLIN; -1 before open() and after the end of standard input.
  int descriptor() const { return descriptor_; }

  /// The next of the poses that have come; nothing if that was the last. Empty lines and # comments are passed over.
  std::optional<Pose> next();

  std::uint64_t damaged() const { return damaged_; }  ///< lines that are no pose, passed over

 private:
  bool fill();
  void close();
  std::optional<std::string_view> next_line();

  int descriptor_ = -1;
  std::array<char, 4096> buffer_{};
  std::size_t begin_ = 0, end_ = 0;  ///< what has been read and not yet given
  bool skipping_ = false;            ///< the rest of a line for which there was no room
  std::uint64_t damaged_ = 0;
};

}  // namespace curbline::daemon
