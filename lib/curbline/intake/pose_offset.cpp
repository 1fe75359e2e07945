#include "curbline/intake/pose_offset.hpp"

#include "curbline/math.hpp"

namespace curbline {
namespace {

/// ln 20: a probability of 5 %.
constexpr float sure = 3.0f;

/// Log likelihood ratio of the localisation to the robot, from poses that after a jump go on at the speed before it. A
/// localisation's always do; of the jumps of simulated robots that climb curbs, one in 31 with poses of 50 Hz, one in
/// 13 with 10 Hz (tools/streets --drive). Also the log odds, at first, that it was the robot in a climb, where one jump
/// follows the other.
constexpr float rarely = 3.0f;

/// Variance of a step known from five poses, in units of that of one pose (PoseTrack).
constexpr float poses_of_a_step = 2.625f;

/// Three standard deviations of such a step, squared: poses show larger ones.
constexpr float least_detectable = gate * poses_of_a_step;

/// Poses that a comparison depends on: of the line, and of those that mapped the ground.
constexpr float poses_compared = 2.0f;

/// Share of a standard deviation of the poses by which an offset fades a line: one in 400 lines, longer than ground
/// stays in the window.
constexpr float fade_share = 0.0025f;

float faded(float value, float by) {
  return value > by ? value - by : value < -by ? value + by : 0.0f;
}

}  // namespace

void PoseOffset::init(const PoseSettings& settings) {
  *this = PoseOffset{};
  height_variance_m2_ = square(settings.height_sd_m);
  attitude_variance_ = square(settings.attitude_sd_rad);
  const float slope = fade_share * settings.attitude_sd_rad;
  fades_ = {fade_share * settings.height_sd_m, slope, slope};
}

void PoseOffset::begin_line(float x_m, float y_m) {
  x_m_ = x_m;
  y_m_ = y_m;
  for (PoseShift* shift : {&offset_, &stepped_}) {
    *shift = {faded(shift->height_m, fades_.height_m), faded(shift->slope_x, fades_.slope_x),
              faded(shift->slope_y, fades_.slope_y)};
  }
}

void PoseOffset::follow(const PoseStepNews& step) {
  switch (step.kind) {
    case PoseStepNews::Kind::begun:
      settle();
      open(offset_ - step.by, poses_of_a_step * height_variance_m2_, poses_of_a_step * attitude_variance_);
      break;
    case PoseStepNews::Kind::confirmed:
      confirmed_ = true;
      evidence_ += rarely;
      break;
    case PoseStepNews::Kind::withdrawn:
      undecided_ = likelier_ = false;
      break;
    case PoseStepNews::Kind::climbed:
      // Nothing to decide for a localisation that was never found to step, or for exact poses.
      if (!localisation_steps_ || !(height_variance_m2_ + attitude_variance_ > 0.0f)) break;
      settle();
      open(offset_, least_detectable * height_variance_m2_, least_detectable * attitude_variance_);
      confirmed_ = climbed_ = true;
      evidence_ = -rarely;
      break;
  }
}

PoseOffset PoseOffset::suspecting(const PoseJumps& jumps, bool climbs) const {
  PoseOffset suspect = *this;
  suspect.settle();
  const float least = climbs ? least_detectable : 0.0f;
  suspect.open(suspect.offset_, jumps.height_m2 + least * height_variance_m2_,
               jumps.attitude_rad2 + least * attitude_variance_);
  return suspect;
}

void PoseOffset::open(const PoseShift& stepped, float height_variance_m2, float attitude_variance) {
  stepped_ = stepped;
  covariance_ = {};
  covariance_[0][0] = height_variance_m2;
  covariance_[1][1] = covariance_[2][2] = attitude_variance;
  undecided_ = true;
  confirmed_ = climbed_ = false;
  evidence_ = 0.0f;
}

void PoseOffset::settle() {
  if (likelier_) offset_ = stepped_;
  undecided_ = likelier_ = false;
}

/// A point that neither cause explains is of another surface.
void PoseOffset::compare(const Sighting& seen) {
  ++points_;
  const float dx = seen.x_m - x_m_, dy = seen.y_m - y_m_;
  const float pose_m2 = height_variance_m2_ + attitude_variance_ * (dx * dx + dy * dy);
  const float variance_m2 = seen.variance_m2 + seen.common_variance_m2 + poses_compared * pose_m2;
  const float lacks_m = offset().at(dx, dy) - seen.above_m;  // the offset that would put the point on the ground
  if (square(lacks_m - offset_.at(dx, dy)) > gate * variance_m2 &&
      square(lacks_m - stepped_.at(dx, dy)) > gate * (variance_m2 + step_variance_m2(dx, dy)))
    return;
  const float w = 1.0f / seen.variance_m2;
  seen_.w += w;
  seen_.x += w * dx;
  seen_.y += w * dy;
  seen_.xx += w * dx * dx;
  seen_.xy += w * dx * dy;
  seen_.yy += w * dy * dy;
  seen_.z += w * lacks_m;
  seen_.xz += w * dx * lacks_m;
  seen_.yz += w * dy * lacks_m;
  seen_.common_m2 += seen.common_variance_m2 + poses_compared * pose_m2;
  ++seen_.points;
}

float PoseOffset::step_variance_m2(float dx, float dy) const {
  const auto& p = covariance_;
  return p[0][0] + dx * (2.0f * p[0][1] + dx * p[1][1]) + dy * (2.0f * (p[0][2] + dx * p[1][2]) + dy * p[2][2]);
}

/// An observation linear in the offset: its likelihoods, and the Kalman update.
void PoseOffset::see(const Row& of, float correction, float variance) {
  const auto off = [&](const PoseShift& shift) {
    return correction - (of[0] * shift.height_m + of[1] * shift.slope_x + of[2] * shift.slope_y);
  };
  Row cross{};
  float total = variance;
  for (std::size_t a = 0; a < states; ++a) {
    for (std::size_t b = 0; b < states; ++b) cross[a] += covariance_[a][b] * of[b];
    total += of[a] * cross[a];
  }
  const float weight = off(stepped_) / total;
  evidence_ += 0.5f * (square(off(offset_)) / variance - weight * off(stepped_) + log(variance) - log(total));
  stepped_ = stepped_ + PoseShift{cross[0] * weight, cross[1] * weight, cross[2] * weight};
  for (std::size_t a = 0; a < states; ++a) {
    for (std::size_t b = 0; b < states; ++b) covariance_[a][b] -= cross[a] * cross[b] / total;
  }
}

/// A line's points lie on a straight line of the ground. They show its height, and its slope along the axis of their
/// greatest scatter.
PoseShift PoseOffset::end_line() {
  const Sums s = seen_;
  const int points = points_;
  seen_ = Sums{};
  points_ = 0;
  compared_ = s.points > 0 && 2 * s.points >= points;
  if (!compared_) return {};
  const PoseShift before = offset();
  const float x = s.x / s.w, y = s.y / s.w, z = s.z / s.w;
  const float xx = s.xx - s.x * x, xy = s.xy - s.x * y, yy = s.yy - s.y * y;
  see({1.0f, x, y}, z, 1.0f / s.w + s.common_m2 / static_cast<float>(s.points));
  const float half = 0.5f * (xx - yy), greatest = 0.5f * (xx + yy) + square_root(half * half + xy * xy);
  float ux = half > 0.0f ? greatest - yy : xy, uy = half > 0.0f ? xy : greatest - xx;
  const float length = square_root(ux * ux + uy * uy);
  if (length > 0.0f && greatest > 0.0f) {  // points at one place have no axis
    ux /= length;
    uy /= length;
    see({0.0f, ux, uy}, (ux * (s.xz - s.x * z) + uy * (s.yz - s.y * z)) / greatest,
        1.0f / greatest + poses_compared * attitude_variance_);
  }
  likelier_ = climbed_ ? evidence_ >= sure && large() : evidence_ > 0.0f;
  const PoseShift after = offset();
  // After a climb, the robot is settled on when lines alone make it 20 times likelier.
  if (confirmed_ && (evidence_ <= (climbed_ ? -sure - rarely : -sure) || evidence_ >= sure)) {
    localisation_steps_ = localisation_steps_ || likelier_;
    settle();
  }
  return after - before;
}

/// Is the step as large as one that poses would show?
bool PoseOffset::large() const {
  const PoseShift by = stepped_ - offset_;
  return square(by.height_m) > least_detectable * height_variance_m2_ ||
         square(by.slope_x) + square(by.slope_y) > least_detectable * attitude_variance_;
}

float PoseOffset::doubt_m2(float x_m, float y_m) const {
  return undecided_ ? square(at(stepped_ - offset_, x_m, y_m)) : 0.0f;
}

/// Turned by a small angle about the horizontal axis of the slopes.
Pose PoseOffset::corrected(const Pose& pose) const {
  const PoseShift& by = offset();
  const float ax = 0.5f * by.slope_y, ay = -0.5f * by.slope_x;
  Pose out = pose;
  out.z_m += by.height_m;
  out.qw = pose.qw - ax * pose.qx - ay * pose.qy;
  out.qx = pose.qx + ax * pose.qw + ay * pose.qz;
  out.qy = pose.qy + ay * pose.qw - ax * pose.qz;
  out.qz = pose.qz + ax * pose.qy - ay * pose.qx;
  return out;
}

}  // namespace curbline
