#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "evaluation/labels.hpp"
#include "formats/bad_input.hpp"
#include "formats/cloud.hpp"
#include "formats/decimals.hpp"
#include "formats/file_exists.hpp"
#include "formats/regions.hpp"
#include "formats/shipped.hpp"
#include "program/evaluate.hpp"
#include "program/map_cloud.hpp"
#include "program/map_window.hpp"
#include "program/replay.hpp"

namespace curbline::tools {
namespace {

/// One cloud in the paper's window.
struct PaperCloud {
  std::string name;
  Map curbline, reference;
  double v_curbline = 0, v_reference = 0;
  bool same_place = false;  ///< scan-03 to scan-12 were taken from one place
};

MapOptions paper_window(MapMethod method) {
  MapOptions options;
  options.origin = {0, 0};
  options.size = {4, 4};
  options.cell = {0.1};
  options.max_height_m = 0.3;
  options.method = method;
  return options;
}

std::vector<std::string> cloud_names(const std::string& data) {
  std::vector<std::string> names;
  std::error_code failed;
  for (const auto& entry : std::filesystem::directory_iterator(data, failed)) {
    if (entry.path().extension() == ".gt") names.push_back(entry.path().stem().string());
  }
  if (failed) throw BadInput(data + ": " + failed.message() + "; expected a folder of clouds");
  if (names.empty()) throw BadInput(data + ": no regions (.gt) in this folder; expected scan-NN.gt beside scan-NN.xyz");
  std::sort(names.begin(), names.end());
  return names;
}

PaperCloud load(const std::string& data, const std::string& name) {
  const std::vector<Point3> points = read_cloud(data + "/" + name + ".xyz");
  const std::vector<Polygon> regions = read_regions(data + "/" + name + ".gt");
  PaperCloud cloud;
  cloud.name = name;
  cloud.same_place = name >= "scan-03" && name <= "scan-12";
  cloud.curbline = map_cloud(points, paper_window(MapMethod::curbline));
  cloud.reference = map_cloud(points, paper_window(MapMethod::crf_em));
  const std::vector<int> region = regions_of_cells(cloud.curbline.grid, regions);
  cloud.v_curbline = v_measure(cloud.curbline, region);
  cloud.v_reference = v_measure(cloud.reference, region);
  return cloud;
}

struct MeanSd {
  double mean = 0, sd = 0;
};

MeanSd mean_sd(const std::vector<double>& values) {
  if (values.empty()) return {std::nan(""), std::nan("")};
  MeanSd out;
  for (const double v : values) out.mean += v / static_cast<double>(values.size());
  for (const double v : values) out.sd += (v - out.mean) * (v - out.mean) / static_cast<double>(values.size());
  out.sd = std::sqrt(out.sd);
  return out;
}

std::string shown(const MeanSd& v) {
  return std::isnan(v.mean) ? "-" : decimals(v.mean, 3) + " +- " + decimals(v.sd, 3);
}
std::string shown(double metres) {
  return std::isnan(metres) ? "-" : decimals(metres, 4);
}

/// Over all clouds, or over those from one place.
MeanSd mean_v(const std::vector<PaperCloud>& clouds, double PaperCloud::*v, bool all) {
  std::vector<double> values;
  for (const PaperCloud& cloud : clouds) {
    if (all || cloud.same_place) values.push_back(cloud.*v);
  }
  return mean_sd(values);
}

/// Mean over training clouds of the mean over the others; NaN if there are fewer than two.
double prediction(std::span<const Map> maps) {
  std::vector<double> of_training;
  for (const Map& trained : maps) {
    std::vector<double> of_other;
    for (const Map& other : maps) {
      if (&trained != &other) of_other.push_back(prediction_rmse(trained, other));
    }
    if (!of_other.empty()) of_training.push_back(mean_sd(of_other).mean);
  }
  return of_training.empty() ? std::nan("") : mean_sd(of_training).mean;
}

/// Maps each sweep separately, from its points as projected by one pipeline that all sweeps go through in turn: with
/// the tilt angle at each beam's time and the tilt latency estimated at the end. Empty if a stream is missing.
std::vector<Map> map_streams(const std::string& data, const std::vector<PaperCloud>& clouds) {
  const std::string robot_file = shipped_file("robots", "clausius");
  if (robot_file.empty()) return {};
  Robot robot = read_robot(robot_file);
  apply_window(paper_window(MapMethod::curbline), robot.window);
  auto pipeline = make_host_pipeline(robot);
  struct Sweep {
    std::vector<Point> points;
    float mended_s;  ///< the corrections made up to the next sweep
  };
  std::vector<Sweep> sweeps;
  for (const PaperCloud& cloud : clouds) {
    if (!cloud.same_place) continue;
    const DriveLogs logs{data + "/" + cloud.name + ".carmen", data + "/" + cloud.name + ".candump", {}};
    if (!file_exists(logs.scans) || !file_exists(logs.can)) return {};
    Replay replay(robot, logs, std::move(pipeline));
    Sweep& sweep = sweeps.emplace_back();
    while (replay.step(&sweep.points)) continue;
    replay.check_complete();
    pipeline = replay.take_pipeline();
    sweep.mended_s = pipeline->tilt_latency().mended_s();
  }
  std::vector<Map> maps;
  for (Sweep& sweep : sweeps) {
    const float later_s = pipeline->tilt_latency().mended_s() - sweep.mended_s;
    for (Point& point : sweep.points) point.z_m += point.growth_m_s * later_s;
    const auto alone = make_host_pipeline(robot);
    alone->observe(sweep.points);
    alone->settle();
    maps.push_back(alone->map());
  }
  return maps;
}

/// Root mean square of the difference of two maps' cells, for the worst pair.
double worst_pair(std::span<const Map> maps) {
  double worst = maps.size() > 1 ? 0 : std::nan("");
  for (const Map& a : maps) {
    for (const Map& b : maps) worst = std::max(worst, height_rms(a, b));
  }
  return worst;
}

struct Predictions {
  double curbline = 0, streamed = 0, reference = 0, worst_pair = 0;  ///< NaN if there is nothing to compare
};

Predictions predictions(const std::vector<PaperCloud>& clouds, std::span<const Map> streamed) {
  std::vector<Map> curbline, reference;
  for (const PaperCloud& cloud : clouds) {
    if (!cloud.same_place) continue;
    curbline.push_back(cloud.curbline);
    reference.push_back(cloud.reference);
  }
  return {prediction(curbline), prediction(streamed), prediction(reference), worst_pair(streamed)};
}

}  // namespace

nlohmann::json evaluate_paper(const std::string& data, bool print) {
  std::vector<PaperCloud> clouds;
  for (const std::string& name : cloud_names(data)) clouds.push_back(load(data, name));

  nlohmann::json out;
  if (print) std::printf("V-measure, x and y in [0, 4] m   curbline   reference crf-em\n");
  for (const PaperCloud& cloud : clouds) {
    if (print) std::printf("  %-30s %8.3f %12.3f\n", cloud.name.c_str(), cloud.v_curbline, cloud.v_reference);
    out["v"][cloud.name] = {{"curbline", cloud.v_curbline}, {"crf-em", cloud.v_reference}};
  }
  const MeanSd v = mean_v(clouds, &PaperCloud::v_curbline, false);
  const MeanSd v_reference = mean_v(clouds, &PaperCloud::v_reference, false);
  const MeanSd v_all = mean_v(clouds, &PaperCloud::v_curbline, true);
  const MeanSd v_all_reference = mean_v(clouds, &PaperCloud::v_reference, true);
  const Predictions rmse = predictions(clouds, map_streams(data, clouds));
  out["v_same_place"] = {{"curbline", v.mean}, {"crf-em", v_reference.mean}};
  out["v_all"] = {{"curbline", v_all.mean}, {"crf-em", v_all_reference.mean}};
  out["rmse_m"] = {
      {"curbline", rmse.curbline}, {"curbline, streams", rmse.streamed}, {"crf-em", rmse.reference}, {"paper", 0.016}};
  out["worst_pair_m"] = {{"curbline, streams", rmse.worst_pair}};
  if (print) {
    std::printf("\n%-32s %-16s %-16s %s\n", "", "curbline", "crf-em", "paper");
    const auto row = [](const char* name, auto curbline, auto reference, const char* paper) {
      std::printf("%-32s %-16s %-16s %s\n", name, shown(curbline).c_str(), shown(reference).c_str(), paper);
    };
    row("V, scan-03 to scan-12", v, v_reference, "0.96 +- 0.03 (33 clouds)");
    row("V, all clouds here", v_all, v_all_reference, "");
    row("RMSE of prediction, clouds, m", rmse.curbline, rmse.reference, "0.016");
    row("RMSE of prediction, streams, m", rmse.streamed, std::nan(""), "");
    row("sweep against sweep, worst, m", rmse.worst_pair, std::nan(""), "");
  }
  return out;
}

}  // namespace curbline::tools
