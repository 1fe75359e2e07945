// Scan lines of a recorded cloud that lie off their neighbours. A recorder that joins the beams of a line with a tilt
// angle of another time turns the whole line about the laser: a stripe above or below the ground, across all that the
// line sees, which looks like two curbs. (Recorded street 08: one line of 264, 16 ms late, 2 cm off at 5 m.) A stream
// has the times of angles and beams, and the pipeline interpolates; a cloud only has the order of its points.
//
// A line is recognised among three before it and three after it, all along its bearings: it lies off the straight line
// through the others (Theil 1950, Sen 1968) by more than twice as far as any of them, as a step between two lines does
// not, off which the nearest line lies 5/3 times as far as the next; and by more than lines of this cloud do by chance.
#pragma once

#include <span>
#include <vector>

#include "map/map.hpp"

namespace curbline::tools {

/// By how much each point lies too high, metres, as its scan line is turned about a horizontal axis through the laser,
/// which is at x = y = 0; 0 for points of lines that lie well. Points are in the order in which they were measured,
/// clockwise or counter-clockwise, or else no line is recognised. O(points log points).
std::vector<double> mistimed_lift_m(std::span<const Point3> cloud);

}  // namespace curbline::tools
