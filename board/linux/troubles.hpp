// Writes faults and recoveries to the journal: each when it begins, not while it continues.
#pragma once

#include <array>
#include <cstdint>

#include "journal.hpp"
#include "reports.hpp"

namespace curbline::daemon {

/// What has happened to the sources since they were last told of.
struct SourceEvents {
  SourceEvent tilt, nod, poses, sight;  ///< nod, sight: lost or recovered
};

class Troubles {
 public:
  /// Compares with what was reported before. Call several times a second. `now_ns`: of any clock.
  void tell(const Report& status, const SourceEvents& events, std::int64_t now_ns);

 private:
  void tell_link(socketcan::LinkState link);
  void tell_scanner(const ScannerState& scanner);
  void tell_counters(const Report& status, std::int64_t now_ns);

  socketcan::LinkState link_ = socketcan::LinkState::up;
  bool scanner_connected_ = false, scanner_told_ = false;
  std::array<Trouble, 24> counted_{};
};

}  // namespace curbline::daemon
