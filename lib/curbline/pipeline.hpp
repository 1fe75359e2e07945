// curbline: scan lines and tilt angles in, curbs out. One object of fixed size, one call a scan line:
//
//   tilt readings --> TiltTrack --+
//   poses ----------> PoseTrack --+
//   scan line --------------------+--> LineProjection --> Dem --> Segmentation --> PlaneMixture <--> LabelField --+
//   \_________________ LineIntake _________________/                                                              |
//   curbs <------------------------------------------------------------------------------------ CurbTracer <------+
//
// No heap, no exceptions, no I/O, no clock. Its constructor fills it, so start-up code must run those of static objects
// (.init_array; board/common/runtime.cpp does). Settings are checked once, in init(); bad data is dropped and counted.
// add_tilt() may be called from an interrupt; all other calls come from one context, or from two that exclude each
// other.
#pragma once

#include <cstdint>
#include <span>

#include "curbline/assertion.hpp"
#include "curbline/counters.hpp"
#include "curbline/curbs/crossed_cells.hpp"
#include "curbline/curbs/curb_tracer.hpp"
#include "curbline/curbs/ground_label.hpp"
#include "curbline/curbs/passability.hpp"
#include "curbline/intake/line_intake.hpp"
#include "curbline/intake/map_comparison.hpp"
#include "curbline/intake/pose_track.hpp"
#include "curbline/intake/tilt_latency.hpp"
#include "curbline/labels/label_field.hpp"
#include "curbline/limits.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/planes/common_noise.hpp"
#include "curbline/planes/plane_mixture.hpp"
#include "curbline/pose.hpp"
#include "curbline/regions/segmentation.hpp"
#include "curbline/scan_line.hpp"
#include "curbline/settings.hpp"
#include "curbline/status.hpp"
#include "curbline/tilt_reading.hpp"
#include "curbline/workspace.hpp"

namespace curbline {

template <Limits limits>
class Pipeline {
 public:
  static_assert(limits.rows > 0 && limits.rows % block_side == 0 && limits.cols > 0 && limits.cols % block_side == 0,
                "Limits: rows and cols must be multiples of 4 above 0, as the window is made of whole blocks");
  static_assert(limits.rows < 32768 && limits.cols < 32768, "Limits: rows and cols must be below 32768");
  static_assert(limits.planes >= 2 && limits.planes <= 255, "Limits: planes must be 2 to 255, as label 255 says none");
  static_assert(limits.borders >= 1 && limits.borders < 65535,
                "Limits: borders must be 1 to 65534, as a border's number is 16 bits, of which 65535 says none");
  static_assert(limits.curbs >= 1 && limits.curbs <= 65535,
                "Limits: curbs must be 1 to 65535, as each has a number of 16 bits other than 0");
  static_assert(limits.beams >= 1 && limits.poses >= 1 && limits.regions >= 1 && limits.links >= 1,
                "Limits: beams, poses, regions and links must be 1 at least");

  /// Checks the settings and empties everything. A Status other than ok names the part with a bad setting, and
  /// bad_setting(settings, limits) the setting itself; the pipeline then refuses lines, points and poses, and has no
  /// curbs, labels or passable cells (planes and cells keep what they were). May be called again to start afresh, as
  /// long as nothing calls add_tilt() meanwhile: mask its interrupt, or stop its thread.
  // Cold, as are the large functions that it calls: compiled for size, not speed.
  [[gnu::cold]] Status init(const Settings& settings);

  /// A reading of the tilt servo. Wait-free; may be called from one interrupt or one other thread. False if dropped:
  /// not finite, beyond TiltReading::furthest_rad, not later than the one before. init() forgets earlier readings.
  bool add_tilt(const TiltReading& reading) { return line_intake_.add_tilt(reading); }

  /// A pose of the base in the map frame. False if dropped: not finite, not later than the one before, beyond
  /// Pose::furthest_m, its quaternion not of unit length, the robot on its back, as by a quaternion with qw first, or
  /// before init().
  bool add_pose(const Pose& pose);

  /// Takes a scan line: observe(), then one half of infer(): after one line regions and planes, after the next labels
  /// and curbs, for both, so that no line costs more than a quarter of what a small core can do between two. Its tilt
  /// readings and poses should be in already: beams later than the newest are extrapolated, within
  /// TiltSettings::max_extrapolation_s. Bounded by the limits. A refused line (not_initialised, line_too_long,
  /// line_out_of_order, no_pose, no_tilt) changes nothing but counters.
  Status take(const ScanLine& line);

  /// Beams to points, points to cells. About 170 operations a beam, 120 outside the window.
  Status observe(const ScanLine& line);

  /// In place of observe(): hands the points that it would put into cells, in the map frame, in the window or beside
  /// it, to take(const Point&). The line counts as taken; the window follows the robot.
  template <typename Take>
  Status project(const ScanLine& line, Take&& take);

  /// The same for points that are already in the map frame: a recorded cloud, another sensor.
  void observe(std::span<const Point> points);

  /// Updates regions, planes, labels and curbs with what was observed since the last time. As often as time allows.
  void infer();

  /// infer() for a finished map: repeats the pass over the labels, with no bound on messages, until no label changes or
  /// `passes` (at least 1) are made, then judges and fits the planes by these labels and the curbs, as further lines
  /// would, and repeats the passes, at most as many again. The noise that cells share keeps its value: one sweep does
  /// not show it. Returns the passes made, of the last repetition.
  int settle(int passes = 10);

  /// Curbs in the window, in the map frame. take() traces them every second line: they may be a line old, and lie in
  /// the window as it was then. Valid until the next take(), infer(), settle() or init().
  std::span<const Curb> curbs() const { return ready_ ? curb_tracer_.curbs() : std::span<const Curb>{}; }

  /// May a robot that can take steps of max_step_m and slopes of max_slope_rad drive on cell (i, j) of the window, or
  /// over one of curbs()? A curb may be a line older than the planes. Outside the window the ground is unknown, and not
  /// passable. About 20 operations a curb for a cell. See passability.hpp.
  bool passable(int i, int j, float max_step_m, float max_slope_rad) const {
    const Mobility mobility{max_step_m, max_slope_rad};
    return knows(i, j) && curbline::passable(dem_, plane_mixture_, label_field_, i, j, mobility) &&
           !in_the_way(dem_, curbs(), i, j, mobility);
  }
  bool passable(const Curb& curb, float max_step_m, float max_slope_rad) const {
    const auto side = [this](int label) { return label == no_label ? Plane{} : plane(label); };
    return ready_ && curbline::passable(curb, side(curb.near_label), side(curb.far_label), {max_step_m, max_slope_rad});
  }

  /// The plane of ground that the readings in cell (i, j) most likely belong to; below an obstacle, that of the cells
  /// around. no_label without readings, outside the window, or as long as no plane of ground is known. i counts along
  /// x, j along y, from the window's lowest corner: 0 <= i < dem().rows(), 0 <= j < dem().cols(). A label may outlive
  /// its plane by a line.
  Label label(int i, int j) const { return knows(i, j) ? label_field_.label(dem_.slot(i, j)) : no_label; }
  /// The probability of that label; 0 outside the window and before init(). A cell that waits for its turn may have its
  /// region's label (LabelField::update()): then it is what that plane had there before, 0 as a rule.
  float label_probability(int i, int j) const;
  /// The plane of the ground under the cell's middle; beside a step, not always that of the readings. no_label where
  /// label() is. See ground_label.hpp.
  Label ground_label(int i, int j) const {
    return knows(i, j) ? curbline::ground_label(dem_, plane_mixture_, label_field_, curbs(), i, j) : no_label;
  }
  /// A plane, in the window's frame (origin at its lowest corner, z of the map frame). 0 <= label < limits.planes;
  /// no_label is not allowed: any other label is a bug, see assertion.hpp.
  const Plane& plane(int label) const {
    expects(label >= 0 && label < limits.planes, "plane(): 0 <= label < limits.planes");
    return plane_mixture_.plane(label);
  }
  /// The name of the surface that a plane is part of: planes along one bent surface, such as a cambered road, share the
  /// lowest of their labels, and no crease is reported between them. For any other plane its own label, and no_label
  /// for no_label; a label from limits.planes on is a bug, as in plane(). See surfaces.hpp.
  Label surface(Label label) const {
    expects(label == no_label || label < limits.planes, "surface(): label < limits.planes, or no_label");
    return ready_ ? curb_tracer_.surfaces().name(label) : label;
  }
  const Dem<limits>& dem() const { return dem_; }
  const Counters& counters() const { return counters_; }
  /// What is added to the poses, against steps of the localisation, about the robot's place: see pose_offset.hpp.
  const PoseShift& pose_offset() const { return line_intake_.pose_offset().offset(); }
  const TiltLatency& tilt_latency() const { return line_intake_.tilt_latency(); }
  const Settings& settings() const { return settings_; }

 private:
  /// Is there an answer about this cell? Slots wrap: outside the window they are those of the opposite side.
  bool knows(int i, int j) const { return ready_ && dem_.contains(i, j); }
  void follow_robot(const Transform& T_map_base);
  void look_from(const Transform& T_map_base);
  void take_point(const Point& point);
  void follow_regions();
  int follow_labels(FieldScope scope);
  int settle_labels(int passes);
  void follow_curbs();
  void follow_noise();
  Viewpoint view() const {
    Viewpoint view{p_map_tilt_.x() - dem_.origin_x_m(), p_map_tilt_.y() - dem_.origin_y_m(), p_map_tilt_.z()};
    view.divergence_rad = settings_.laser.beam_divergence_rad;
    view.bearing_step_rad = magnitude(settings_.laser.bearing_step_rad);
    view.localisation_steps = line_intake_.pose_offset().localisation_steps();
    if (settings_.pose.still || settings_.window.fixed) return view;
    view.end_x_m = dem_.length_m(0);
    view.end_y_m = dem_.length_m(1);
    return view;
  }

  Settings settings_{};
  bool ready_ = false;
  bool planes_next_ = true;                               ///< which half of the inference is due
  bool unrefined_ = false;                                ///< planes were fitted since settle()
  Eigen::Vector3f p_map_tilt_ = Eigen::Vector3f::Zero();  ///< where the tilt axis is, of the last line
  Counters counters_{};
  LineIntake<limits> line_intake_{};
  Dem<limits> dem_{};
  Segmentation<limits> segmentation_{};
  PlaneMixture<limits> plane_mixture_{};
  CommonNoise<limits> common_noise_{};
  LabelField<limits> label_field_{};
  CurbTracer<limits> curb_tracer_{};
  Workspace<limits> workspace_{};
};

template <Limits limits>
Status Pipeline<limits>::init(const Settings& settings) {
  ready_ = false;
  if (const Status status = check(settings, limits); status != Status::ok) return status;
  settings_ = settings;
  PlanePrior& prior = settings_.planes.prior;
  const float by_range_m2 = 0.5f * square(settings.laser.range_sd_m);  // of the height, where rays fall at 45 degrees
  if (prior.noise_m2 < by_range_m2) prior.noise_m2 = by_range_m2;
  counters_ = Counters{};
  planes_next_ = true;
  unrefined_ = false;
  line_intake_.init(settings);
  p_map_tilt_ = line_intake_.T_base_tilt().translation;
  dem_.init(settings.window, prior);
  if (settings.pose.still) look_from(Transform{});
  segmentation_.init(settings.segmentation, prior);
  plane_mixture_.init(settings_.planes);
  common_noise_.init();
  label_field_.init(settings.labels);
  curb_tracer_.init(settings.curbs);
  ready_ = true;
  return Status::ok;
}

template <Limits limits>
bool Pipeline<limits>::add_pose(const Pose& pose) {
  if (ready_ && line_intake_.add_pose(pose)) return true;
  ++counters_.poses_dropped;
  return false;
}

template <Limits limits>
Status Pipeline<limits>::take(const ScanLine& line) {
  const Status status = observe(line);
  if (status != Status::ok) return status;
  if (planes_next_) {
    follow_regions();
  } else {
    follow_labels(FieldScope::line);
    follow_curbs();
    follow_noise();
  }
  planes_next_ = !planes_next_;
  return status;
}

template <Limits limits>
Status Pipeline<limits>::observe(const ScanLine& line) {
  return project(line, [this](const Point& point) { take_point(point); });
}

template <Limits limits>
template <typename Take>
Status Pipeline<limits>::project(const ScanLine& line, Take&& take) {
  auto& work = workspace_.line();
  const Status status = ready_ ? line_intake_.place(line, dem_, work) : Status::not_initialised;
  counters_.tilt_dropped = line_intake_.tilt_dropped();
  if (status != Status::ok) {
    ++counters_.lines_dropped;
    return status;
  }
  ++counters_.lines;
  if (!work.motion.still) follow_robot(work.motion.T_map_base_last);
  const MapComparison<limits> map(dem_, plane_mixture_, label_field_, settings_.segmentation.link_reach);
  const bool taken = line_intake_.project(line, map, dem_, work, counters_);
  counters_.outside += work.projected.outside();
  if (!taken) return Status::ok;
  for (const Point& p : work.projected.points()) take(p);
  return Status::ok;
}

template <Limits limits>
void Pipeline<limits>::observe(std::span<const Point> points) {
  if (!ready_) return;
  for (const Point& point : points) take_point(point);
}

template <Limits limits>
void Pipeline<limits>::take_point(const Point& point) {
  if (dem_.add(point)) {
    ++counters_.points;
  } else {
    ++counters_.outside;
  }
}

/// Moves the window with the robot; what leaves it leaves every stage.
template <Limits limits>
void Pipeline<limits>::follow_robot(const Transform& T_map_base) {
  const float before_x = dem_.origin_x_m(), before_y = dem_.origin_y_m();
  dem_.follow(T_map_base, [this](int slot) {
    segmentation_.forget(slot);
    plane_mixture_.forget(slot);
    label_field_.forget(slot);
  });
  plane_mixture_.shift(dem_.origin_x_m() - before_x, dem_.origin_y_m() - before_y);
  look_from(T_map_base);
}

template <Limits limits>
void Pipeline<limits>::look_from(const Transform& T_map_base) {
  const Transform& T_base_tilt = line_intake_.T_base_tilt();
  p_map_tilt_ = T_map_base * T_base_tilt.translation;
  // Along y of the tilt frame: a greater tilt lowers what lies to the right of it, looking along it from above.
  const Eigen::Vector3f axis = rotated(T_map_base.rotation, T_base_tilt.rotation.col(1));
  dem_.look_from(p_map_tilt_.x(), p_map_tilt_.y(), {-axis.x(), axis.y()});
}

template <Limits limits>
void Pipeline<limits>::infer() {
  if (!ready_) return;
  follow_regions();
  follow_labels(FieldScope::line);
  follow_curbs();
  follow_noise();
}

template <Limits limits>
int Pipeline<limits>::settle(int passes) {
  if (!ready_) return 0;
  follow_regions();
  const int pass = settle_labels(passes);
  if (!unrefined_ || plane_mixture_.mode() == PlaneUpdate::responsibilities) return pass;
  unrefined_ = false;
  plane_mixture_.refine(dem_, view(), crossed_cells(dem_, curbs()),
                        [this](int slot) { return label_field_.label(slot); });
  return settle_labels(passes);
}

/// Labels of a finished map, and curbs by them. Returns the passes made.
template <Limits limits>
int Pipeline<limits>::settle_labels(int passes) {
  const bool planes_move = plane_mixture_.mode() == PlaneUpdate::responsibilities;
  int pass = 1;
  for (int changed = follow_labels(FieldScope::window); changed > 0 && pass < passes; ++pass) {
    changed = follow_labels(planes_move ? FieldScope::window : FieldScope::changed);
  }
  follow_curbs();
  return pass;
}

template <Limits limits>
void Pipeline<limits>::follow_regions() {
  auto& work = workspace_.segmentation();
  unrefined_ = unrefined_ || dem_.any_touched();
  segmentation_.update(
      dem_, work, plane_mixture_.largest_ground(), [this](int slot) { return plane_mixture_.obstructed(dem_, slot); },
      counters_);
  plane_mixture_.update(
      dem_, work, view(), crossed_cells(dem_, curbs()), [this](int slot) { return label_field_.label(slot); },
      counters_);
  label_field_.note_touched(dem_);
  dem_.clear_touched();
}

/// E-step, and the M-step if planes come from responsibilities. Returns how many labels changed.
template <Limits limits>
int Pipeline<limits>::follow_labels(FieldScope scope) {
  const int changed = label_field_.update(dem_, plane_mixture_, scope, workspace_.visits(), counters_);
  plane_mixture_.forget_changes();
  if (plane_mixture_.mode() == PlaneUpdate::responsibilities) {
    plane_mixture_.maximise(dem_, [this](int i, int j, auto&& visit) {
      const auto belief = label_field_.belief(dem_, dem_.slot(i, j));
      for (std::size_t c = 0; c < belief.label.size(); ++c) {
        if (belief.label[c] != no_label) visit(belief.label[c], belief.probability[c]);
      }
    });
  }
  return changed;
}

template <Limits limits>
void Pipeline<limits>::follow_curbs() {
  curb_tracer_.trace(dem_, plane_mixture_, label_field_, view(), tilt_latency().doubt(), workspace_.curbs(), counters_);
}

template <Limits limits>
void Pipeline<limits>::follow_noise() {
  common_noise_.follow(dem_, plane_mixture_);
  dem_.set_common(common_noise_.common_m2(settings_.planes.prior, tilt_latency().sd_s()), common_noise_.line_m2());
}

template <Limits limits>
float Pipeline<limits>::label_probability(int i, int j) const {
  return knows(i, j) ? label_field_.belief(dem_, dem_.slot(i, j)).of(label(i, j)) : 0.0f;
}

}  // namespace curbline
