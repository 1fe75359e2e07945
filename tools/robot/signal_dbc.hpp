// Converts between a robot's description and DBC: the tilt signal and the curb frames as DBC messages, and a signal of
// a DBC file as the table of a description.
#pragma once

#include <string>

#include "formats/dbc.hpp"
#include "robot/robot.hpp"

namespace curbline::tools {

/// The frames of the robot's servo: the message TiltServo with the signal Tilt, and Sync if the drive samples on it.
/// What DBC has no words for (id_mask, min_bytes, max_bytes, sync_id) is in attributes, and the id's bits that count in
/// a comment for people, too.
Dbc dbc_of(const Robot& robot);

/// The frames of curbline/can/curb_frames.hpp.
Dbc curb_dbc();

/// The tables [tilt.signal] and [tilt.signal.multiplexor], ready to paste into a description; `source` is written above
/// as a comment. Degrees, turns and milliradians are converted to radians; a comment points out a unit that is not an
/// angle.
std::string tilt_toml(const DbcTiltSignal& found, const std::string& source);

}  // namespace curbline::tools
