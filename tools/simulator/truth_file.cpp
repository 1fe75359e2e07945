// truth.json, out and in.
#include "formats/bad_input.hpp"
#include "simulator/truth.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

namespace curbline::tools {

using Json = nlohmann::ordered_json;

static void to_json(Json& json, const Point2& p) {
  json = Json::array({p.x, p.y});
}
static void from_json(const Json& json, Point2& p) {
  p = {json.at(0).get<double>(), json.at(1).get<double>()};
}

namespace {

Json planes_json(const Truth& truth) {
  Json out = Json::array();
  for (const TruthPlane& p : truth.planes) {
    out.push_back({{"name", p.name}, {"z0_m", p.plane.z0_m}, {"sx", p.plane.sx}, {"sy", p.plane.sy}});
  }
  return out;
}

Json regions_json(const Truth& truth) {
  Json out = Json::array();
  for (const TruthRegion& r : truth.regions) {
    out.push_back({{"name", r.name}, {"plane", r.plane}, {"polygon_m", r.outline}});
  }
  return out;
}

Json curbs_json(const Truth& truth) {
  Json out = Json::array();
  for (const TruthCurb& c : truth.curbs) {
    out.push_back({{"x0_m", c.from.x},
                   {"y0_m", c.from.y},
                   {"x1_m", c.to.x},
                   {"y1_m", c.to.y},
                   {"step0_m", c.from_step_m},
                   {"step1_m", c.to_step_m},
                   {"left_z_m", c.left_z_m},
                   {"right_z_m", c.right_z_m},
                   {"height_m", c.height_m},
                   {"kind", c.kind}});
  }
  return out;
}

Json obstacles_json(const Truth& truth) {
  Json out = Json::array();
  for (const TruthObstacle& o : truth.obstacles) {
    out.push_back({{"name", o.name}, {"polygon_m", o.outline}});
  }
  return out;
}

void take(const Json& json, Truth& truth) {
  const auto number = [](const Json& owner, const char* key) { return owner.at(key).get<double>(); };
  const auto text = [](const Json& owner, const char* key) { return owner.at(key).get<std::string>(); };
  const auto polygon = [](const Json& owner) { return owner.at("polygon_m").get<Polygon>(); };
  truth.start_time_s = number(json, "start_time_s");
  for (const Json& p : json.at("planes")) {
    truth.planes.push_back({text(p, "name"), {number(p, "z0_m"), number(p, "sx"), number(p, "sy")}});
  }
  for (const Json& r : json.at("regions")) {
    truth.regions.push_back({text(r, "name"), polygon(r), r.at("plane").get<int>()});
    truth.planes.at(static_cast<std::size_t>(truth.regions.back().plane));  // throws if there is no such plane
  }
  for (const Json& c : json.at("curbs")) {
    truth.curbs.push_back({{number(c, "x0_m"), number(c, "y0_m")},
                           {number(c, "x1_m"), number(c, "y1_m")},
                           number(c, "step0_m"),
                           number(c, "step1_m"),
                           number(c, "left_z_m"),
                           number(c, "right_z_m"),
                           number(c, "height_m"),
                           text(c, "kind")});
  }
  for (const Json& o : json.at("obstacles")) {
    truth.obstacles.push_back({text(o, "name"), polygon(o)});
  }
}

}  // namespace

void write_truth(std::ostream& out, const Truth& truth) {
  Json json{{"start_time_s", truth.start_time_s}};
  json["planes"] = planes_json(truth);
  json["regions"] = regions_json(truth);
  json["curbs"] = curbs_json(truth);
  json["obstacles"] = obstacles_json(truth);
  out << json.dump(1) << "\n";
}

Truth read_truth(const std::string& dir) {
  const std::string path = dir + "/truth.json";
  std::ifstream in(path);
  if (!in) {
    throw BadInput(path + ": cannot be read; expected what simulate wrote");
  }
  Truth truth;
  try {
    take(Json::parse(in), truth);
  } catch (const std::exception& error) {
    throw BadInput(path + ": " + error.what() + "; expected what simulate wrote");
  }
  return truth;
}

}  // namespace curbline::tools
