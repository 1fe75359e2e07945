#include "curbline/status.hpp"

namespace curbline {

const char* to_string(Status status) {
  switch (status) {
    case Status::ok:
      return "ok";
    case Status::not_initialised:
      return "not initialised";
    case Status::bad_window:
      return "bad window settings";
    case Status::bad_laser:
      return "bad laser settings";
    case Status::bad_tilt:
      return "bad tilt settings";
    case Status::bad_pose:
      return "bad pose settings";
    case Status::bad_inference:
      return "bad inference settings";
    case Status::line_out_of_order:
      return "scan line is not later than the one before";
    case Status::line_too_long:
      return "scan line has more beams than the laser";
    case Status::no_tilt:
      return "no tilt angle near the scan line's time";
    case Status::no_pose:
      return "no pose near the scan line's time";
  }
  return "unknown status";
}

}  // namespace curbline
