// The parts of a robot file that have their own source file. read_robot() combines them.
#pragma once

#include "formats/toml_table.hpp"
#include "robot/robot.hpp"

namespace curbline::tools {

void read_laser(TomlTable laser, Robot& robot);         ///< [laser]: the model's data sheet, then the other keys
void read_tilt_signal(TomlTable signal, Robot& robot);  ///< [tilt.signal]: the servo's preset, then the other keys
void read_tuning(TomlTable tuning, Robot& robot);       ///< [tuning]

}  // namespace curbline::tools
