// The parts of a robot file that have a source file of their own. read_robot() puts them together.
#pragma once

#include "robot/robot.hpp"
#include "robot/robot_table.hpp"

namespace curbline::tools {

void read_laser(RobotTable laser, Robot& robot);         ///< [laser]: the model's data sheet, then the other keys
void read_tilt_signal(RobotTable signal, Robot& robot);  ///< [tilt.signal]: the servo's preset, then the other keys
void read_tuning(RobotTable tuning, Robot& robot);       ///< [tuning]

}  // namespace curbline::tools
