#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "curbline/evaluate.hpp"
#include "curbline/map_cloud.hpp"
#include "evaluation/labels.hpp"
#include "formats/cloud.hpp"
#include "formats/regions.hpp"

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
  if (values.empty()) return {};
  MeanSd out;
  for (const double v : values) out.mean += v / static_cast<double>(values.size());
  for (const double v : values) out.sd += (v - out.mean) * (v - out.mean) / static_cast<double>(values.size());
  out.sd = std::sqrt(out.sd);
  return out;
}

/// Mean over training clouds of the mean over the others.
double prediction(const std::vector<PaperCloud>& clouds, Map PaperCloud::*map) {
  std::vector<double> of_training;
  for (const PaperCloud& trained : clouds) {
    std::vector<double> of_other;
    for (const PaperCloud& other : clouds) {
      if (trained.same_place && other.same_place && trained.name != other.name)
        of_other.push_back(prediction_rmse(trained.*map, other.*map));
    }
    if (!of_other.empty()) of_training.push_back(mean_sd(of_other).mean);
  }
  return mean_sd(of_training).mean;
}

}  // namespace

nlohmann::json evaluate_paper(const std::string& data, bool print) {
  std::vector<PaperCloud> clouds;
  for (const std::string& name : cloud_names(data)) clouds.push_back(load(data, name));

  nlohmann::json out;
  std::vector<double> here_curbline, here_reference, all_curbline, all_reference;
  if (print) std::printf("V-measure, x and y in [0, 4] m   curbline   reference crf-em\n");
  for (const PaperCloud& cloud : clouds) {
    if (print) std::printf("  %-30s %8.3f %12.3f\n", cloud.name.c_str(), cloud.v_curbline, cloud.v_reference);
    out["v"][cloud.name] = {{"curbline", cloud.v_curbline}, {"crf-em", cloud.v_reference}};
    all_curbline.push_back(cloud.v_curbline);
    all_reference.push_back(cloud.v_reference);
    if (!cloud.same_place) continue;
    here_curbline.push_back(cloud.v_curbline);
    here_reference.push_back(cloud.v_reference);
  }
  const MeanSd v = mean_sd(here_curbline), v_reference = mean_sd(here_reference), v_all = mean_sd(all_curbline),
               v_all_reference = mean_sd(all_reference);
  const double rmse = prediction(clouds, &PaperCloud::curbline),
               rmse_reference = prediction(clouds, &PaperCloud::reference);
  out["v_same_place"] = {{"curbline", v.mean}, {"crf-em", v_reference.mean}};
  out["v_all"] = {{"curbline", v_all.mean}, {"crf-em", v_all_reference.mean}};
  out["rmse_m"] = {{"curbline", rmse}, {"crf-em", rmse_reference}, {"paper", 0.016}};
  if (print) {
    std::printf("\n%-32s %-16s %-16s %s\n", "", "curbline", "crf-em", "paper");
    std::printf("%-32s %.3f +- %.3f  %.3f +- %.3f  0.96 +- 0.03 (33 clouds)\n", "V, scan-03 to scan-12", v.mean, v.sd,
                v_reference.mean, v_reference.sd);
    std::printf("%-32s %.3f +- %.3f  %.3f +- %.3f\n", "V, all clouds here", v_all.mean, v_all.sd, v_all_reference.mean,
                v_all_reference.sd);
    std::printf("%-32s %-16.4f %-16.4f 0.016\n", "RMSE of prediction, m", rmse, rmse_reference);
  }
  return out;
}

}  // namespace curbline::tools
