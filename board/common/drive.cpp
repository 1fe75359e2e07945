#include "drive.hpp"

namespace curbline {

// The boards' pipeline, compiled once, for the budgets and the check of undefined symbols.
template class Pipeline<board::limits>;

namespace board {

const char* to_string(DriveEnd end) {
  switch (end) {
    case DriveEnd::done:
      return "done";
    case DriveEnd::cut_record:
      return "a record is cut";
    case DriveEnd::no_setup:
      return "the first record is not the setup; expected a stream of curbline-drive-log";
    case DriveEnd::other_build:
      return "the stream is of another build; expected one of this build's curbline-drive-log";
    case DriveEnd::setup_refused:
      return "the pipeline refuses the settings";
    case DriveEnd::no_bus:
      return "the CAN bus does not carry frames";
    case DriveEnd::unknown_record:
      return "a record of unknown kind";
    case DriveEnd::no_room_for_results:
      return "a result cannot be written";
  }
  return "?";
}

}  // namespace board
}  // namespace curbline
