// The cost of each scan line of a replay, for drives on which nothing may grow: a CSV with one row a line,
//   x_m,y_m,take_s,evidences,messages,dropped,full,deferred
// x y are those of the robot's newest pose, take_s is the time within Pipeline::take(); the other columns are what the
// line added to Counters: its work, whether it was dropped, storage limits that it reached, and labels deferred to a
// later line.
#pragma once

#include <string>

#include "curbline/counters.hpp"
#include "formats/atomic_file.hpp"
#include "program/replay.hpp"

namespace curbline::tools {

class LineCosts {
 public:
  /// Throws BadInput if the file cannot be written.
  explicit LineCosts(const std::string& path);

  /// Adds the line that the replay has just taken.
  void add(const Replay& replay);

  /// Throws BadInput if not everything could be written; the file is then removed.
  void commit() { file_.commit(); }

 private:
  AtomicFile file_;
  Counters before_;
};

}  // namespace curbline::tools
