// What each scan line of a replay cost, for drives on which nothing may grow: a CSV with a row a line,
//   x_m,y_m,take_s,evidences,messages,dropped,full,deferred
// x y are the robot's newest pose, take_s the time within Pipeline::take(); the rest is what the line added to
// Counters: its work, whether it was dropped, bounds of storage that it hit, and labels that wait for a later line.
#pragma once

#include <string>

#include "curbline/counters.hpp"
#include "formats/atomic_file.hpp"
#include "program/replay.hpp"

namespace curbline::tools {

class LineCosts {
 public:
  /// Throws BadInput if nothing can be written there.
  explicit LineCosts(const std::string& path);

  /// The line that the replay has just taken.
  void add(const Replay& replay);

  /// Throws BadInput if not everything could be written: then nothing is left of it.
  void commit() { file_.commit(); }

 private:
  AtomicFile file_;
  Counters before_;
};

}  // namespace curbline::tools
