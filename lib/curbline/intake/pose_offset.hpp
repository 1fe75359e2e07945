// The correction of poses for steps of the localisation. A localisation that corrects itself makes poses step
// (PoseStepNews); so does a robot that meets a curb, if poses are far apart in time. The laser decides which it was:
// lines after the step see ground mapped before it, and their heights differ from the map's by the step, or not at all.
// The likelihood ratio is accumulated line by line until it reaches 20 or 1/20; meanwhile a Kalman filter estimates how
// large the localisation's step is. While the localisation is the likelier cause, the step is taken off the poses: the
// map continues where it was, its z that of the poses up to this offset, which fades, by less than the poses' noise,
// until both agree again. A step of the localisation during a climb is considered only if it has stepped before, and
// accepted if the lines make it 20 times likelier although it was 20 times less likely at first. Cost: 60 operations a
// point, of lines measured while poses jump, and of those after a step or a climb until it is decided, mostly one.
#pragma once

#include <array>
#include <cstddef>

#include "curbline/intake/pose_track.hpp"
#include "curbline/settings.hpp"

namespace curbline {

class PoseOffset {
 public:
  void init(const PoseSettings& settings);

  /// A line begins, with the robot at this place.
  void begin_line(float x_m, float y_m);
  /// News of a step, from a pose before the line. An earlier step that is undecided is settled as is likelier.
  void follow(const PoseStepNews& step);

  /// Has the localisation been found to step? Then it may do so while the robot climbs, too.
  bool localisation_steps() const { return localisation_steps_; }
  /// Is it open whether the last step was the localisation's?
  bool undecided() const { return undecided_; }
  /// Is the step in question one during a climb, of unknown size?
  bool climbed() const { return climbed_; }
  /// Is the localisation the likelier cause?
  bool likelier() const { return likelier_; }

  /// A copy that suspects a step from now on, known only to be about as large as the poses have jumped, for a line
  /// measured while they do, or as the least step that poses would show, between jumps of a robot that climbs.
  PoseOffset suspecting(const PoseJumps& jumps, bool climbs) const;

  /// A point of the line, and the ground there, mapped before the step.
  struct Sighting {
    float x_m, y_m;            ///< in the map frame
    float above_m;             ///< its height above that ground
    float variance_m2;         ///< the independent part of its variance
    float common_variance_m2;  ///< the part shared with the line's other points: latency, the ground's slope
  };
  void compare(const Sighting& seen);
  /// A point of the line without such ground.
  void pass() { ++points_; }

  /// The line ends. Returns what is to be added to its heights, about the robot's place.
  PoseShift end_line();
  /// Did half of the line that has ended lie on ground mapped before?
  bool compared() const { return compared_; }

  /// What is added to poses, about the robot's place.
  const PoseShift& offset() const { return likelier_ ? stepped_ : offset_; }
  Pose corrected(const Pose& pose) const;
  /// The change of a height elsewhere in the map, by a shift about the robot's place.
  float at(const PoseShift& shift, float x_m, float y_m) const { return shift.at(x_m - x_m_, y_m - y_m_); }
  /// Square of the error of a height elsewhere if the less likely hypothesis, step or climb, is the true one.
  float doubt_m2(float x_m, float y_m) const;

 private:
  static constexpr std::size_t states = 3;  ///< height and two slopes, as in PoseShift
  using Row = std::array<float, states>;

  /// Weighted sums of a line's sightings: normal equations of a plane.
  struct Sums {
    float w = 0.0f, x = 0.0f, y = 0.0f, xx = 0.0f, xy = 0.0f, yy = 0.0f, z = 0.0f, xz = 0.0f, yz = 0.0f;
    float common_m2 = 0.0f;
    int points = 0;
  };
  void see(const Row& of, float correction, float variance);
  void settle();
  bool large() const;
  void open(const PoseShift& stepped, float height_variance_m2, float attitude_variance);
  float step_variance_m2(float dx_m, float dy_m) const;

  float x_m_ = 0.0f, y_m_ = 0.0f;         ///< the robot's place
  PoseShift offset_{};                    ///< if the last step was the robot's ...
  PoseShift stepped_{};                   ///< ... and if it was the localisation's
  std::array<Row, states> covariance_{};  ///< of stepped_
  bool localisation_steps_ = false;
  bool undecided_ = false;
  bool confirmed_ = false;  ///< poses have confirmed the step, or the robot has climbed ...
  bool climbed_ = false;    ///< ... and no pose could show one
  bool likelier_ = false;   ///< the localisation is the likelier cause
  bool compared_ = false;
  float evidence_ = 0.0f;  ///< log likelihood ratio, above 0 for the localisation
  Sums seen_{};
  int points_ = 0;  ///< of the current line
  float height_variance_m2_ = 0.0f, attitude_variance_ = 0.0f;
  PoseShift fades_{};  ///< by so much a line
};

}  // namespace curbline
