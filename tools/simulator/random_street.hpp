// Random streets, for measuring accuracy on more than the scenes that ship. The same seed gives the same text.
//
// A curb of random direction crosses the window of a standing robot, x in [0, 4] m and y in [-2, 2] m; the robot stands
// on either side of it. A third of the streets each are straight, curved, or have a side road that opens into the main
// one. Steps are 2 to 15 cm, four in ten of them at most 4 cm; there may be a second step on the pavement and a
// pavement across the road. The ground slopes by up to 4 %, the cross slope of pavements and road is up to 2.5 %.
// Straight curbs may be lowered to 0 to 1 cm for wheelchairs, with flanks; a straight road may rise by a ramp to a
// table. There may be posts, boxes, a parked car and a house, none closer to the robot than 0.9 m.
#pragma once

#include <cstdint>
#include <string>

namespace curbline::tools {

/// Whether the robot stands, or drives through the street at 1 m/s, from 3 m behind that place to 3 m in front of it.
/// When driving it crosses any curbs on its path, and obstacles are at least 0.9 m away from the path.
enum class StreetRobot { stands, drives };

/// The text of a scene file.
std::string random_street(std::uint64_t seed, StreetRobot robot);

}  // namespace curbline::tools
