// Arbitrary settings, readings, poses, points and lines, in any order: settings are accepted or refused by name.
// Whatever comes then, the pipeline's output can be used.
#include <cstdint>
#include <span>
#include <vector>

#include "curbline/curbline.hpp"
#include "fuzz/claim.hpp"
#include "fuzz/run.hpp"

namespace curbline::fuzz {
namespace {

/// So small that every store is soon full, and every cell is near a border of the window.
constexpr Limits limits{.rows = 12,
                        .cols = 12,
                        .planes = 4,
                        .beams = 24,
                        .tilt_samples = 8,
                        .poses = 6,
                        .regions = 12,
                        .links = 24,
                        .borders = 24,
                        .curbs = 4};
Pipeline<limits> pipeline;

MountSettings some_mount(Numbers& numbers) {
  MountSettings mount;
  numbers.change(mount.x_m, -100.0f, 100.0f);
  numbers.change(mount.y_m, -100.0f, 100.0f);
  numbers.change(mount.z_m, -100.0f, 100.0f);
  for (float* angle : {&mount.roll_rad, &mount.pitch_rad, &mount.yaw_rad}) numbers.change(*angle, -6.28f, 6.28f);
  return mount;
}

/// Settings of a robot that stands 1 m above the ground or drives, some of them changed.
Settings some_settings(Numbers& numbers) {
  Settings s;
  s.window.rows = s.window.cols = 12;
  s.window.origin_y_m = -0.6f;
  s.laser.beams = limits.beams;
  s.laser.first_bearing_rad = -0.6f;
  s.laser.bearing_step_rad = 0.05f;
  s.tilt.T_base_tilt.z_m = 1.0f;
  s.pose = {.still = numbers.flag(), .height_sd_m = 0.003f, .attitude_sd_rad = 0.001f};
  s.tilt.fixed = numbers.flag();
  s.tilt.fixed_tilt_rad = 1.1f;
  if (numbers.flag()) return s;

  WindowSettings& w = s.window;
  numbers.change(w.rows, 4, 12);
  numbers.change(w.cols, 4, 12);
  numbers.change(w.cell_x_m, 0.001f, 10.0f);
  numbers.change(w.cell_y_m, 0.001f, 10.0f);
  numbers.change(w.origin_x_m, -1e5f, 1e5f);
  numbers.change(w.origin_y_m, -1e5f, 1e5f);
  numbers.change(w.max_height_m, -1e3f, 1e9f);
  w.fixed = numbers.flag();

  LaserSettings& l = s.laser;
  numbers.change(l.beams, 1, limits.beams);
  numbers.change(l.first_bearing_rad, -6.28f, 6.28f);
  numbers.change(l.bearing_step_rad, -1.0f, 1.0f);
  numbers.change(l.beam_interval_s, 0.0f, 1.0f);
  numbers.change(l.min_range_m, 0.0f, 1e6f);
  numbers.change(l.max_range_m, 0.0f, 1e6f);
  numbers.change(l.range_sd_m, 0.0f, 10.0f);
  numbers.change(l.bearing_sd_rad, 0.0f, 1.0f);
  numbers.change(l.beam_divergence_rad, 0.0f, 1.0f);

  TiltSettings& t = s.tilt;
  if (numbers.flag()) t.T_base_tilt = some_mount(numbers);
  if (numbers.flag()) t.T_tilt_laser = some_mount(numbers);
  numbers.change(t.fixed_tilt_rad, -3.14f, 3.14f);
  numbers.change(t.latency_s, -10.0f, 10.0f);
  numbers.change(t.max_gap_s, 0.0f, 10.0f);
  numbers.change(t.max_extrapolation_s, 0.0f, 10.0f);
  for (float* sd : {&t.latency_sd_s, &t.angle_sd_rad, &t.time_sd_s, &t.roll_sd_rad, &t.pitch_sd_rad})
    numbers.change(*sd, 0.0f, 1.0f);

  numbers.change(s.pose.height_sd_m, 0.0f, 10.0f);
  numbers.change(s.pose.attitude_sd_rad, 0.0f, 1.0f);
  numbers.change(s.pose.lean_sd_rad, 0.0f, 0.05f);
  numbers.change(s.pose.max_extrapolation_s, 0.0f, 10.0f);

  numbers.change(s.segmentation.cell.degrees, 1e-3f, 1e6f);
  numbers.change(s.segmentation.cell.variance_m2, 1e-10f, 100.0f);
  numbers.change(s.segmentation.leaf_scale, 0.0f, 1e3f);
  for (int* reach : {&s.segmentation.link_reach, &s.labels.link_reach, &s.curbs.link_reach})
    numbers.change(*reach, 1, max_link_reach);
  PlanePrior& prior = s.planes.prior;
  numbers.change(prior.noise_m2, 1e-10f, 100.0f);
  numbers.change(prior.texture_m2, 0.0f, prior.noise_m2 >= 0.0f ? prior.noise_m2 : 100.0f);  // it may be any by now
  numbers.change(prior.degrees, 1.0f, 1e6f);
  numbers.change(prior.common_share, 0.01f, 1.0f);
  numbers.change(prior.curvature_1_m, 0.0f, 10.0f);
  numbers.change(s.planes.min_cells, 3.0f, 1e6f);
  if (numbers.flag()) s.planes.update = PlaneUpdate::responsibilities;
  numbers.change(s.labels.coupling, 0.01f, 7.9f);
  if (numbers.flag()) s.labels.max_messages = numbers.whole(0, 100);
  numbers.change(s.curbs.max_step_m, 0.0f, 100.0f);
  return s;
}

/// What a robot sees: a scan line of the ground with a step across it and noise, and some arbitrary readings.
class Street {
 public:
  explicit Street(Numbers& numbers) : numbers_(numbers) {}

  void drive_on() {
    time_ns_ = numbers_.seldom() ? numbers_.time_ns() : time_ns_ % (INT64_MAX / 2) + 25'000'000;
    angle_rad_ += numbers_.number(-0.1f, 0.1f);
    if (!(angle_rad_ > 0.3f && angle_rad_ < 1.4f)) angle_rad_ = 0.7f;
    x_m_ += numbers_.number(0.0f, 0.05f);
    if (numbers_.seldom()) z_m_ = numbers_.number(-0.2f, 0.2f);  // a curb, or its localisation corrects itself
  }
  TiltReading reading() { return {time_ns_, numbers_.rarely_any(angle_rad_)}; }
  Pose pose() {
    Pose pose{.time_ns = time_ns_ + 13'000'000, .x_m = numbers_.rarely_any(x_m_), .z_m = numbers_.rarely_any(z_m_)};
    if (numbers_.seldom()) {
      for (float* part : {&pose.y_m, &pose.qx, &pose.qy, &pose.qz, &pose.qw}) *part = numbers_.any();
    }
    return pose;
  }
  ScanLine line() {
    const float step_m = numbers_.number(-0.3f, 0.3f), noise_m = numbers_.number(0.0f, 0.03f);
    const auto edge = static_cast<std::size_t>(numbers_.whole(0, limits.beams));
    ranges_m_.resize(static_cast<std::size_t>(numbers_.seldom() ? numbers_.whole(0, limits.beams + 2) : limits.beams));
    for (std::size_t i = 0; i < ranges_m_.size(); ++i) {
      const float height_m = 1.0f - (i < edge ? step_m : 0.0f);
      const float bearing_rad = -0.6f + 0.05f * static_cast<float>(i);
      ranges_m_[i] = numbers_.rarely_any(height_m / (sin_cos(angle_rad_).sin * sin_cos(bearing_rad).cos) + noise_m);
    }
    return {time_ns_, ranges_m_};
  }
  std::vector<Point> cloud() {
    std::vector<Point> points(static_cast<std::size_t>(numbers_.whole(0, 30)));
    for (Point& p : points) {
      p = {numbers_.rarely_any(numbers_.number(0.0f, 1.2f)), numbers_.rarely_any(numbers_.number(-0.6f, 0.6f)),
           numbers_.rarely_any(numbers_.number(0.0f, 0.2f)), numbers_.rarely_any(1e-4f), numbers_.rarely_any(0.0f)};
    }
    return points;
  }

 private:
  Numbers& numbers_;
  std::int64_t time_ns_ = 0;
  float angle_rad_ = 0.7f, x_m_ = 0.0f, z_m_ = 0.0f;
  std::vector<float> ranges_m_;
};

void look_at_curbs() {
  const std::span<const Curb> curbs = pipeline.curbs();
  for (const Curb& curb : curbs) {
    for (const float number : {curb.x0_m, curb.y0_m, curb.x1_m, curb.y1_m, curb.position_sd_m, curb.height_m,
                               curb.height_sd_m, curb.face_width_m, curb.probability})
      claim(is_finite(number), "every number of a curb is finite");
    claim(curb.position_sd_m >= 0.0f && curb.height_sd_m >= 0.0f, "no deviation is below 0");
    claim(curb.face_width_m >= 0.0f, "no face is narrower than 0");
    claim(curb.probability >= 0.0f && curb.probability <= 1.0f, "a probability lies from 0 to 1");
    claim(curb.near_label < limits.planes, "the near side is a plane");
    claim(curb.far_label < limits.planes || curb.far_label == no_label, "so is the far one, if it is seen");
    claim(curb.id != 0, "a curb has a number");
    for (const Curb& other : curbs) claim(&other == &curb || other.id != curb.id, "and no other has it");
    pipeline.passable(curb, 0.05f, 0.1f);
  }
}

void look_at_cells() {
  for (int i = 0; i < pipeline.dem().rows(); ++i) {
    for (int j = 0; j < pipeline.dem().cols(); ++j) {
      for (const Label label : {pipeline.label(i, j), pipeline.ground_label(i, j)})
        claim(label < limits.planes || label == no_label, "a cell's label is a plane's, or none");
      const float probability = pipeline.label_probability(i, j);
      claim(probability >= 0.0f && probability <= 1.0f, "a label's probability lies from 0 to 1");
      pipeline.passable(i, j, 0.05f, 0.1f);
    }
  }
}

}  // namespace

void run(Numbers& numbers) {
  const Settings settings = some_settings(numbers);
  const bool good = pipeline.init(settings) == Status::ok;
  claim(good == (bad_setting(settings, limits) == nullptr), "a pipeline refuses what has a bad setting, no more");
  Street street(numbers);
  while (!numbers.used_up()) {
    street.drive_on();
    if (!numbers.seldom()) pipeline.add_tilt(street.reading());
    if (!numbers.seldom()) pipeline.add_pose(street.pose());
    switch (numbers.whole(0, 9)) {
      case 0:
        pipeline.observe(street.cloud());
        break;
      case 1:
        pipeline.observe(street.line());
        break;
      case 2:
        pipeline.infer();
        break;
      case 3:
        pipeline.settle(numbers.whole(-1, 4));
        break;
      case 4:
        pipeline.project(street.line(), [](const Point&) {});
        break;
      default: {
        const Status status = pipeline.take(street.line());
        claim((status == Status::not_initialised) == !good, "lines are taken once there are settings");
      }
    }
    look_at_curbs();
    look_at_cells();
  }
}

}  // namespace curbline::fuzz
