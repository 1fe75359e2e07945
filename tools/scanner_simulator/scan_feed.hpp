// The scan lines of a simulated scanner: those of a CARMEN log, or of a robot in a scene (the same as `curbline
// simulate` writes, so that its CAN log belongs to them).
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "formats/carmen.hpp"
#include "robot/robot.hpp"
#include "simulator/scene.hpp"

namespace curbline::tools {

class ScanFeed {
 public:
  /// All lines must have the beams of the first, and times that do not go back: a scanner's clock does not.
  static ScanFeed from_log(const std::string& path);
  static ScanFeed from_scene(const Scene& scene, const Robot& robot);

  /// The next line; nothing at the end. Throws BadInput for errors in a log.
  std::optional<CarmenLine> next();

  /// The next line without removing it: all lines have its geometry, and its time is when it is due. nullptr at the
  /// end.
  const CarmenLine* front() const { return front_ ? &*front_ : nullptr; }

 private:
  using Source = std::function<std::optional<CarmenLine>()>;
  explicit ScanFeed(Source source) : source_(std::move(source)), front_(source_()) {}

  Source source_;
  std::optional<CarmenLine> front_;
};

}  // namespace curbline::tools
