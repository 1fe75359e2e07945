#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "command_line/outputs.hpp"
#include "evaluation/curbs.hpp"
#include "formats/bad_input.hpp"
#include "formats/csv.hpp"
#include "formats/file_exists.hpp"
#include "picture/picture.hpp"
#include "program/evaluate.hpp"
#include "program/recorded_run.hpp"
#include "program/score_table.hpp"

namespace curbline::tools {
namespace {

constexpr double tolerance_m = 0.1;      ///< one cell of the default grid: within it, curbs match
constexpr double found_share = 0.5;      ///< minimum share of a curb's visible length for it to count as found
constexpr double least_visible_m = 0.3;  ///< a few cells: shorter curbs are not listed
constexpr std::size_t most_reference_cells = 6400;  ///< the reference takes minutes for more

/// Everything that is scored, and the truth it is scored against.
struct Evaluation {
  Truth truth;
  std::optional<RecordedRun> run;  ///< from the logs, if there are logs
  Found found;
  bool of_run = true;  ///< `found` is what the pipeline makes of the logs, or what --method does
  Seen seen;
  std::optional<Found> reference;  ///< the results of crf-em on the same sweep
};

/// Results of a method for whole clouds, which are seen from their origin.
Found found_in(const Map& map) {
  return {{labelled_cells(map)}, map.curbs, Point2{0, 0}};
}

/// Whether two lists are the same curbs, to the digits of a CSV.
bool same_curbs(const std::vector<MapCurb>& a, const std::vector<MapCurb>& b) {
  constexpr double digits = 1e-6;
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const MapCurb& x, const MapCurb& y) {
    const auto near = [](double p, double q) { return std::abs(p - q) <= digits; };
    return near(x.x0_m, y.x0_m) && near(x.y0_m, y.y0_m) && near(x.x1_m, y.x1_m) && near(x.y1_m, y.y1_m) &&
           near(x.height_m, y.height_m);
  });
}

/// Takes the results that replay left in DIR: the labels of the last window and the curbs of the whole path. Its window
/// may differ from the robot's, so for a robot that stood the labels define what was seen. Results of another method,
/// window or stretch were not found when the pipeline found its own.
void take_results(const std::string& dir, Evaluation& e) {
  if (e.found.windows.empty()) e.found.windows.emplace_back();
  e.found.labels_file = dir + "/labels.csv";
  e.found.windows.back() = read_labels(e.found.labels_file);
  e.found.curbs = read_curbs(dir + "/curbs.csv");
  e.of_run = e.run && same_curbs(e.found.curbs, e.run->found.curbs);
  if (e.run && !e.of_run) e.run->detections.clear();
  if (!e.run || !e.run->drove) e.seen = Seen{};
  for (const LabelledCell& cell : e.found.windows.back()) e.seen.add(cell.x_m, cell.y_m);
}

/// Throws BadInput if there are neither results nor logs.
Evaluation evaluate_recording(const EvaluateOptions& options) {
  const std::string& dir = options.dir;
  const bool results = file_exists(dir + "/labels.csv") && file_exists(dir + "/curbs.csv");
  Evaluation e;
  e.truth = read_truth(dir);
  if (has_logs(dir)) e.run = replay_recording(dir, e.truth);
  if (!e.run && !results)
    throw BadInput(dir + ": no recording; expected scans.carmen and robot.toml, or labels.csv and curbs.csv");
  if (e.run) {
    e.seen = e.run->seen;
    e.found = e.run->found;
  }
  const bool small = e.run && !e.run->drove && e.run->map.grid.cells() <= most_reference_cells;
  if (small) e.reference = found_in(map_recording(dir, *e.run, MapMethod::crf_em));
  if (options.method) {
    if (!e.run) throw BadInput(dir + ": no logs for --method; expected scans.carmen and robot.toml");
    if (*options.method == MapMethod::curbline) return e;
    if (e.run->drove)
      throw BadInput(dir + ": the robot drove; expected one that stands for a method that takes a whole cloud");
    e.run->map = map_recording(dir, *e.run, *options.method);
    e.run->detections.clear();
    e.found = found_in(e.run->map);
  } else if (results) {
    take_results(dir, e);
  }
  return e;
}

/// One true step, as in the first table and in "curbs".
struct CurbRow {
  Segment line;
  CurbMatch match;
  Detections::Detection detection;
  bool found() const { return match.covered >= found_share; }
};

struct CurbRows {
  std::vector<CurbRow> rows;
  int too_short = 0;  ///< in view, but not in the rows
};

CurbRows curb_rows(const Evaluation& e) {
  const std::vector<CurbMatch> matches = match_steps(e.found, e.truth, e.seen);
  CurbRows of;
  for (std::size_t k = 0; k < matches.size(); ++k) {
    if (matches[k].visible_m < least_visible_m) {
      of.too_short += matches[k].visible_m > 0;
      continue;
    }
    const bool known = e.run && k < e.run->detections.size();
    of.rows.push_back({line_of(e.truth.curbs[k]), matches[k], known ? e.run->detections[k] : Detections::Detection{}});
  }
  return of;
}

void print_rows(const std::vector<CurbRow>& rows) {
  std::printf(
      "  true curb                              step     found       position error   covered       seen to found\n");
  for (const CurbRow& row : rows) {
    const Segment& s = row.line;
    std::printf("  (%6.2f %6.2f) - (%6.2f %6.2f)  %6.1f cm ", s.x0_m, s.y0_m, s.x1_m, s.y1_m, 100 * row.match.step_m);
    if (!row.found()) {
      std::printf("  missed\n");
      continue;
    }
    std::printf(" %6.1f cm  %6.1f cm   %3.0f %% of %5.1f m", 100 * row.match.height_m, 100 * row.match.position_error_m,
                100 * row.match.covered, row.match.visible_m);
    const Detections::Detection& d = row.detection;
    if (d.seen_s && d.found_s) std::printf("  %5.1f s, %.1f m off", *d.found_s - *d.seen_s, d.distance_m);
    std::printf("\n");
  }
}

void print_sum(std::ptrdiff_t found, const CurbRows& of) {
  std::printf("\ncurbs found: %d of %zu", static_cast<int>(found), of.rows.size());
  if (of.too_short > 0)
    std::printf(", without %d of less than %.1f m in view, which only count below", of.too_short, least_visible_m);
  std::printf("\n\n");
}

nlohmann::json rows_json(const std::vector<CurbRow>& rows) {
  nlohmann::json out = nlohmann::json::array();
  for (const CurbRow& row : rows) {
    nlohmann::json json{{"step_m", row.match.step_m},
                        {"found", row.found()},
                        {"height_m", row.match.height_m},
                        {"position_error_m", row.match.position_error_m},
                        {"covered", row.match.covered}};
    const Detections::Detection& d = row.detection;
    if (d.seen_s && d.found_s) {
      json["time_to_detection_s"] = *d.found_s - *d.seen_s;
      json["distance_at_detection_m"] = d.distance_m;
    }
    out.push_back(json);
  }
  return out;
}

DetectionSummary summary_of(const std::vector<CurbRow>& rows) {
  std::vector<double> time, distance;
  for (const CurbRow& row : rows) {
    if (!row.detection.seen_s || !row.detection.found_s) continue;
    time.push_back(*row.detection.found_s - *row.detection.seen_s);
    distance.push_back(row.detection.distance_m);
  }
  return {errors_of(time), errors_of(distance)};
}

Scored scored(const Found& found, const Truth& truth, const Seen& seen) {
  return {score_planes(found, truth), score_curbs(found, truth, seen)};
}

nlohmann::json to_json(const Scored& s) {
  nlohmann::json out = to_json(s.planes);
  out.update(to_json(s.curbs));
  return out;
}

/// Rates over all kinds of curbs, including creases.
Rates all_rates(const Evaluation& e) {
  std::vector<Segment> lines;
  for (const TruthCurb& c : e.truth.curbs) lines.push_back(line_of(c));
  return curb_rates(e.found.curbs, lines, tolerance_m, std::cref(e.seen));
}

void draw(const Evaluation& e, const EvaluateOptions& options) {
  if (!e.run) throw BadInput(options.dir + ": no logs to draw; expected scans.carmen and robot.toml");
  if (!e.of_run) {
    throw BadInput(options.dir +
                   "/curbs.csv: not what replay gives of the logs beside it; expected that, or --method, " +
                   "for a picture of both");
  }
  PictureExtras extras{.title = options.dir, .robot = e.run->robot};
  for (const TruthCurb& c : e.truth.curbs) {
    extras.truth.push_back({c.from.x, c.from.y, c.to.x, c.to.y, c.height_m, 0, 1, c.kind});
  }
  Map map = e.run->map;
  if (!e.run->drove) map.curbs = e.found.curbs;
  draw_picture(map, options.picture, extras);
}

}  // namespace

nlohmann::json evaluate_truth(const EvaluateOptions& options, bool print) {
  if (!options.picture.empty()) check_picture_name(options.picture);
  check_writable({{"--picture", options.picture}});
  const Evaluation e = evaluate_recording(options);
  if (e.run && !e.run->remarks.empty()) std::cerr << e.run->remarks << '\n';
  if (!options.picture.empty()) draw(e, options);  // before anything is printed, because it may be refused
  const Scored here = scored(e.found, e.truth, e.seen);
  std::optional<Scored> reference;
  if (e.reference) reference = scored(*e.reference, e.truth, e.seen);
  const CurbRows listed = curb_rows(e);
  const std::vector<CurbRow>& rows = listed.rows;
  const DetectionSummary detection = summary_of(rows);
  const auto found = std::count_if(rows.begin(), rows.end(), [](const CurbRow& row) { return row.found(); });
  if (print) {
    print_rows(rows);
    print_sum(found, listed);
    print_score_table(here, reference, detection);
  }

  nlohmann::json out = to_json(here);
  out["curbs"] = rows_json(rows);
  out["curbs_visible"] = rows.size();
  out["curbs_found"] = found;
  const Rates rates = all_rates(e);
  out["precision"] = rates.precision;
  out["recall"] = rates.recall;
  out["f1"] = rates.f1;
  out["time_to_detection_median_s"] = detection.time_s.median;
  out["time_to_detection_95_s"] = detection.time_s.most;
  out["distance_at_detection_median_m"] = detection.distance_m.median;
  if (reference) out["reference"] = to_json(*reference);
  out["paper"] = {{"v", paper_v}};
  return out;
}

}  // namespace curbline::tools
