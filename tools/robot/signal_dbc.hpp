// Between a robot's description and DBC: the tilt signal and the curb frames as DBC messages, and a signal of a DBC
// file as the table of a description.
#pragma once

#include <string>

#include "formats/dbc.hpp"
#include "robot/robot.hpp"

namespace curbline::tools {

/// What the robot's servo sends: the message TiltServo with the signal Tilt, and Sync if the drive samples on it. Bits
/// of the id that need not agree are said in a comment, since DBC has no word for them.
Dbc dbc_of(const Robot& robot);

/// The frames of curbline/can/curb_frames.hpp.
Dbc curb_dbc();

/// The tables [tilt.signal] and [tilt.signal.multiplexor], ready to paste into a description; `source` is a comment
/// that goes above. Degrees, turns and milliradians become radians; of a unit that is no angle a comment says so.
std::string tilt_toml(const DbcTiltSignal& found, const std::string& source);

}  // namespace curbline::tools
