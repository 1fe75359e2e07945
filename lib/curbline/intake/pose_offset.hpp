// What a localisation that thinks better of itself has moved the poses by, against the map. Its poses step
// (PoseStepNews), and where poses come seldom so do those of a robot that has met a kerb. The laser alone tells which
// of the two it was: lines after the step look at ground that was mapped before it, and their heights lie off the map's
// by the step, or not at all. Both likelihoods are multiplied up line by line until the one is twenty times the other;
// meanwhile a Kalman filter finds out by how much exactly a localisation has stepped. Poses are set back by the step if
// that is likelier: the map goes on where it was, and its z is that of the poses but for the offset. That fades by less
// than poses tremble, until both are one again. Cost: 60 operations a point of the lines that are measured as poses
// jump, and after a step or a climb until it is decided: mostly one. That a localisation has stepped while the robot
// climbed is asked of one that has stepped before, and taken if it is twenty times likelier though it was as much less
// likely before.
#pragma once

#include <array>
#include <cstddef>

#include "curbline/intake/pose_track.hpp"
#include "curbline/settings.hpp"

namespace curbline {

class PoseOffset {
 public:
  void init(const PoseSettings& settings);

  /// A line begins, with the robot there.
  void begin_line(float x_m, float y_m);
  /// A pose before it has told of a step. What is not decided of an earlier one is taken as it seems to be.
  void follow(const PoseStepNews& step);

  /// Has its localisation been found to step? One that has may do so while the robot climbs.
  bool localisation_steps() const { return localisation_steps_; }
  /// Is it open who has made the last step?
  bool undecided() const { return undecided_; }
  /// Is it a step that a localisation may have made while the robot climbed? By how much no pose tells.
  bool climbed() const { return climbed_; }
  /// Does it seem to be the localisation?
  bool likelier() const { return likelier_; }

  /// With a step from now on of which no more is known than that it is about as large as poses have jumped: of a line
  /// that is measured while they do; or, between jumps of a robot that climbs, as poses tell of.
  PoseOffset suspecting(const PoseJumps& jumps, bool climbs) const;

  /// A point of the line, and the ground there that was mapped before the step.
  struct Sighting {
    float x_m, y_m;            ///< in the map frame
    float above_m;             ///< how far it lies above that ground
    float variance_m2;         ///< of that, its own
    float common_variance_m2;  ///< and what it shares with the line's other points: latency, the slope of the ground
  };
  void compare(const Sighting& seen);
  /// A point of the line where no ground was.
  void pass() { ++points_; }

  /// The line is over. What is to be added to its heights, about where the robot is.
  PoseShift end_line();
  /// Of the line that has ended: did half of it lie on ground that was mapped before?
  bool compared() const { return compared_; }

  /// What is added to poses, about where the robot is.
  const PoseShift& offset() const { return likelier_ ? stepped_ : offset_; }
  Pose corrected(const Pose& pose) const;
  /// What a shift about where the robot is makes of a height elsewhere in the map.
  float at(const PoseShift& shift, float x_m, float y_m) const { return shift.at(x_m - x_m_, y_m - y_m_); }
  /// By how much heights elsewhere may be wrong, squared, if it is the less likely one.
  float doubt_m2(float x_m, float y_m) const;

 private:
  static constexpr std::size_t states = 3;  ///< height and two slopes, as in PoseShift
  using Row = std::array<float, states>;

  /// Of the sightings of a line, weighted: normal equations of a plane.
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

  float x_m_ = 0.0f, y_m_ = 0.0f;         ///< where the robot is
  PoseShift offset_{};                    ///< if the robot has made the last step ...
  PoseShift stepped_{};                   ///< ... and if the localisation has
  std::array<Row, states> covariance_{};  ///< of that
  bool localisation_steps_ = false;
  bool undecided_ = false;
  bool confirmed_ = false;  ///< it was a step
  bool climbed_ = false;    ///< or the robot has climbed, and no pose could tell
  bool likelier_ = false;   ///< the localisation has made it
  bool compared_ = false;
  float evidence_ = 0.0f;  ///< ln of how much likelier that is
  Sums seen_{};
  int points_ = 0;  ///< of the line in hand
  float height_variance_m2_ = 0.0f, attitude_variance_ = 0.0f;
  PoseShift fades_{};  ///< by that much a line
};

}  // namespace curbline
