// Times and sizes, all in one process so that their ratios are comparable: a scan line, a whole map of 1600 cells
// compared with the paper's algorithm, belief messages, bytes for several limits. The data is the simulated street of
// the demo, seen by the robot of the demo.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <variant>
#include <vector>

#include "curbline/can/tilt_decoder.hpp"
#include "reference/reference.hpp"
#include "robot/robot.hpp"
#include "simulator/simulation.hpp"
#include "streams/host_pipeline.hpp"

namespace {

using namespace curbline;
using namespace curbline::tools;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// One recorded nod: the inputs, line by line, and the same as points.
struct Street {
  Settings settings;
  std::vector<TiltReading> tilt;
  std::vector<std::pair<std::int64_t, std::vector<float>>> lines;
  std::vector<Point> points;
  std::vector<Point3> cloud;

  Street() {
    Robot robot = read_robot(CURBLINE_ROBOT);
    settings = pipeline_settings(robot);
    settings.window.fixed = true;  // all 40 x 40 cells in view
    settings.window.origin_x_m = 0.8f;
    Simulation simulation(in_map_frame(find_scene("street")), robot, 1);
    can::TiltDecoder decoder;
    decoder.init(robot.tilt_signal, robot.tilt_sync_id);
    while (const auto event = simulation.next()) {
      if (const auto* line = std::get_if<ScanLine>(&*event)) {
        lines.emplace_back(line->time_ns, std::vector<float>(line->ranges_m.begin(), line->ranges_m.end()));
      } else if (const auto* frame = std::get_if<can::Frame>(&*event)) {
        if (const auto reading = decoder.take(*frame)) tilt.push_back(*reading);
      }
    }
    project();
  }

  /// Feeds readings up to the first after the line's end; returns where to continue.
  template <typename Pipeline>
  std::size_t feed(Pipeline& pipeline, std::size_t next, std::int64_t line_ns) const {
    while (next < tilt.size() && (next == 0 || tilt[next - 1].time_ns < line_ns + 25'000'000))
      pipeline.add_tilt(tilt[next++]);
    return next;
  }

 private:
  void project() {
    const auto pipeline = std::make_unique<Pipeline<board_limits>>();
    pipeline->init(settings);
    std::size_t next = 0;
    for (const auto& [time_ns, ranges] : lines) {
      next = feed(*pipeline, next, time_ns);
      pipeline->project({time_ns, ranges}, [this](const Point& p) { points.push_back(p); });
    }
    for (const Point& p : points) {
      cloud.push_back({static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(p.z_m)});
    }
  }
};

const Street& street() {
  static const Street data;
  return data;
}

/// A nod, line by line: median, 99 % quantile and maximum of all lines, and the median as a share of the 25 ms between
/// lines.
void scan_line(benchmark::State& state) {
  const auto pipeline = std::make_unique<Pipeline<board_limits>>();
  std::vector<double> times;
  for (auto _ : state) {
    pipeline->init(street().settings);
    std::size_t next = 0;
    for (const auto& [time_ns, ranges] : street().lines) {
      next = street().feed(*pipeline, next, time_ns);
      const auto start = Clock::now();
      benchmark::DoNotOptimize(pipeline->take({time_ns, ranges}));
      times.push_back(seconds_since(start));
    }
  }
  std::sort(times.begin(), times.end());
  const double median = times[times.size() / 2], high = times[times.size() * 99 / 100], worst = times.back();
  state.counters["median_us"] = 1e6 * median;
  state.counters["p99_us"] = 1e6 * high;
  state.counters["worst_us"] = 1e6 * worst;
  state.counters["median_share_of_25ms"] = median / 25e-3;
  state.counters["evidences_a_line"] = pipeline->counters().evidences / static_cast<double>(street().lines.size());
  state.counters["messages_a_line"] = pipeline->counters().messages / static_cast<double>(street().lines.size());
}
BENCHMARK(scan_line)->Unit(benchmark::kMillisecond);

double map_by_pipeline(Pipeline<board_limits>& pipeline) {
  const auto start = Clock::now();
  pipeline.init(street().settings);
  pipeline.observe(street().points);
  pipeline.settle();
  return seconds_since(start);
}

double map_by_reference(reference::Messages messages) {
  const WindowSettings& w = street().settings.window;
  const Grid grid{static_cast<double>(w.origin_x_m), static_cast<double>(w.origin_y_m), 0.1, 0.1, w.rows, w.cols};
  reference::Options options;
  options.messages = messages;
  options.max_height_m = static_cast<double>(w.max_height_m);
  const auto start = Clock::now();
  benchmark::DoNotOptimize(reference::map_cloud(street().cloud, grid, options));
  return seconds_since(start);
}

/// Both methods map the same points in turn; times_as_fast is the ratio of the sums.
void whole_map(benchmark::State& state, reference::Messages messages) {
  const auto pipeline = std::make_unique<Pipeline<board_limits>>();
  double ours = 0, theirs = 0;
  for (auto _ : state) {
    ours += map_by_pipeline(*pipeline);
    theirs += map_by_reference(messages);
  }
  const auto n = static_cast<double>(state.iterations());
  state.counters["pipeline_ms"] = 1e3 * ours / n;
  state.counters["crf_em_ms"] = 1e3 * theirs / n;
  state.counters["times_as_fast"] = theirs / ours;
  int valid = 0;
  for (int i = 0; i < pipeline->dem().rows(); ++i) {
    for (int j = 0; j < pipeline->dem().cols(); ++j) valid += pipeline->dem().cell(pipeline->dem().slot(i, j)).valid();
  }
  state.counters["valid_cells"] = valid;
}
BENCHMARK_CAPTURE(whole_map, against_crf_em_with_K_x_K_messages, reference::Messages::general)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(whole_map, against_crf_em_with_O_K_messages, reference::Messages::two_valued)
    ->Unit(benchmark::kMillisecond);

/// Belief propagation over the whole window, in messages a second.
void belief_messages(benchmark::State& state) {
  const auto pipeline = std::make_unique<Pipeline<board_limits>>();
  map_by_pipeline(*pipeline);
  LabelField<board_limits> field;
  field.init(street().settings.labels);
  // The planes of a finished map, as input of the field.
  Segmentation<board_limits> segmentation;
  PlaneMixture<board_limits> mixture;
  Dem<board_limits> dem;
  Counters counters;
  dem.init(street().settings.window, street().settings.planes.prior);
  for (const Point& p : street().points) dem.add(p);
  segmentation.init(street().settings.segmentation, street().settings.planes.prior);
  mixture.init(street().settings.planes);
  Workspace<board_limits> workspace;
  auto& work = workspace.segmentation();
  segmentation.update(
      dem, work, mixture.largest_ground(), [&](int slot) { return mixture.obstructed(dem, slot); }, counters);
  mixture.update(
      dem, work, Viewpoint{}, {}, [&](int slot) { return field.label(slot); }, counters);
  auto& visits = workspace.visits();
  for (auto _ : state) benchmark::DoNotOptimize(field.update(dem, mixture, FieldScope::window, visits, counters));
  state.counters["messages_per_second"] = benchmark::Counter(counters.messages, benchmark::Counter::kIsRate);
}
BENCHMARK(belief_messages)->Unit(benchmark::kMicrosecond);

template <Limits limits>
void bytes(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(sizeof(Pipeline<limits>));
  state.counters["pipeline_KiB"] = sizeof(Pipeline<limits>) / 1024.0;
  state.counters["dem_KiB"] = sizeof(Dem<limits>) / 1024.0;
  state.counters["intake_KiB"] = sizeof(LineIntake<limits>) / 1024.0;
  state.counters["regions_KiB"] = sizeof(Segmentation<limits>) / 1024.0;
  state.counters["planes_KiB"] = (sizeof(PlaneMixture<limits>) + sizeof(CommonNoise<limits>)) / 1024.0;
  state.counters["labels_KiB"] = sizeof(LabelField<limits>) / 1024.0;
  state.counters["curbs_KiB"] = sizeof(CurbTracer<limits>) / 1024.0;
  state.counters["shared_KiB"] = sizeof(Workspace<limits>) / 1024.0;
}
constexpr Limits small_limits{
    .rows = 24, .cols = 24, .planes = 8, .beams = 361, .regions = 160, .links = 480, .borders = 256, .curbs = 64};
BENCHMARK(bytes<small_limits>)->Name("bytes/24x24_8_planes_361_beams")->Iterations(1);
BENCHMARK(bytes<board_limits>)->Name("bytes/40x40_16_planes_1081_beams")->Iterations(1);
BENCHMARK(bytes<wide_limits>)->Name("bytes/128x128_64_planes_2881_beams")->Iterations(1);
BENCHMARK(bytes<largest_limits>)->Name("bytes/512x512_250_planes_2881_beams")->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
