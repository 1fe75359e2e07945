// The raw streams of the paper's data set give the same maps as its clouds.
#include "evaluation/labels.hpp"
#include "formats/csv.hpp"
#include "formats/regions.hpp"
#include "program.hpp"

namespace curbline::tools::testing {
namespace {

const std::string data = CURBLINE_SOURCE_DIR "/../shared/data/clausius/";

/// V-measure of a label file against the hand-drawn regions.
double v_of(const std::string& labels, const std::vector<Polygon>& regions) {
  std::vector<int> region, label;
  for (const LabelledCell& cell : read_labels(labels)) {
    for (std::size_t r = 0; r < regions.size(); ++r) {
      if (!contains(regions[r], {cell.x_m, cell.y_m})) continue;
      region.push_back(static_cast<int>(r));
      label.push_back(cell.cell.label);
      break;
    }
  }
  return v_measure(region, label);
}

void check_same_score(const std::string& scan) {
  if (!std::filesystem::exists(data + scan + ".xyz")) {
    WARN("SKIPPED: no data set at " << data);
    return;
  }
  const TemporaryDirectory dir;
  const Words options{"--origin", "0", "0", "--size", "4", "4", "--cell", "0.1", "--max-height", "0.3", "--labels"};
  const std::string of_cloud = dir.path("cloud.csv"), of_stream = dir.path("stream.csv");
  REQUIRE(curbline(Words{"map", data + scan + ".xyz"} + options + Words{of_cloud}).status == 0);
  REQUIRE(curbline(Words{"replay", "--scans", data + scan + ".carmen", "--can", data + scan + ".candump", "--robot",
                         shipped_robot("clausius")} +
                   options + Words{of_stream})
              .status == 0);
  const std::vector<Polygon> regions = read_regions(data + scan + ".gt");
  const double v_cloud = v_of(of_cloud, regions), v_stream = v_of(of_stream, regions);
  INFO(scan << ": V " << v_cloud << " of the cloud, " << v_stream << " of the stream");
  CHECK(v_stream > v_cloud - 0.02);
  CHECK(v_cloud > 0.8);
}

TEST_CASE("program: the stream of scan-03 is mapped as well as its cloud") {
  check_same_score("scan-03");
}

TEST_CASE("program: the stream of scan-05 is mapped as well as its cloud") {
  check_same_score("scan-05");
}

TEST_CASE("program: the stream of scan-07 is mapped as well as its cloud") {
  check_same_score("scan-07");
}

TEST_CASE("program: the stream of scan-10 is mapped as well as its cloud") {
  check_same_score("scan-10");
}

}  // namespace
}  // namespace curbline::tools::testing
