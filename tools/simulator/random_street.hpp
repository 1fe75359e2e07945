// Random streets, for measuring accuracy on more than the scenes that ship. The same seed gives the same text.
//
// The window of a robot that stands, x in [0, 4] m and y in [-2, 2] m, is crossed by a curb that has any direction; the
// robot stands on either side of it. One street in three is each of: straight, curved, a side road that opens into the
// main one. Steps are 2 to 15 cm, four in ten of them at most 4 cm; there may be a second step on the pavement and a
// pavement across the road. The ground slopes by up to 4 %, pavements and road fall across by up to 2.5 %. Straight
// curbs may be lowered to 0 to 1 cm for wheelchairs, with flanks; a straight road may rise by a ramp to a table. Posts,
// boxes, a parked car and a house stand about, none nearer to the robot than 0.9 m.
#pragma once

#include <cstdint>
#include <string>

namespace curbline::tools {

/// Does the robot stand, or does it drive through the street at 1 m/s, from 3 m behind that place to 3 m before it?
/// Then it goes over what curbs there are, and what stands about is no nearer than 0.9 m to its way.
enum class StreetRobot { stands, drives };

/// A scene file.
std::string random_street(std::uint64_t seed, StreetRobot robot);

}  // namespace curbline::tools
