// Writes and reads truth.json.
#include "curbline/settings.hpp"
#include "formats/bad_input.hpp"
#include "formats/fields.hpp"
#include "formats/whole_file.hpp"
#include "simulator/truth.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace curbline::tools {

using Json = nlohmann::ordered_json;

static void to_json(Json& json, const Point2& p) {
  json = Json::array({p.x, p.y});
}

namespace {

Json planes_json(const Truth& truth) {
  Json out = Json::array();
  for (const TruthPlane& p : truth.planes) {
    out.push_back({{"name", p.name}, {"z0_m", p.plane.z0_m}, {"sx", p.plane.sx}, {"sy", p.plane.sy}});
    const Camber& camber = p.plane.camber;
    if (camber.bend_1_m != 0) {
      out.back()["camber"] = {{"bend_1_m", camber.bend_1_m}, {"crown_m", camber.crown}, {"across", camber.across}};
    }
  }
  return out;
}

Json regions_json(const Truth& truth) {
  Json out = Json::array();
  for (const TruthRegion& r : truth.regions) {
    out.push_back({{"name", r.name}, {"plane", r.plane}, {"polygon_m", r.outline}});
    if (r.face) out.back()["face"] = true;
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

/// A part of the file and the path to it, "curbs[3].x0_m", for errors.
class Part {
 public:
  Part(const Json& json, std::string file, std::string name = {})
      : json_(json), file_(std::move(file)), name_(std::move(name)) {}

  bool has(const std::string& key) const { return json_.is_object() && json_.contains(key); }
  Part at(const std::string& key) const {
    const std::string name = name_.empty() ? key : name_ + "." + key;
    if (!has(key)) throw BadInput(file_ + ": " + name + " is missing; " + expected);
    return {json_.at(key), file_, name};
  }
  std::vector<Part> parts() const {
    check(json_.is_array(), "a list");
    std::vector<Part> out;
    for (const Json& part : json_) out.emplace_back(part, file_, name_ + "[" + std::to_string(out.size()) + "]");
    return out;
  }
  double number(const std::string& key) const { return at(key).number(); }
  double place_m(const std::string& key) const { return at(key).place_m(); }
  /// No window is farther away, and samples along longer lines take long to score.
  double place_m() const {
    const double metres = number();
    check(std::abs(metres) <= static_cast<double>(WindowSettings::furthest_m), "a place within 100 km");
    return metres;
  }
  double time_s(const std::string& key) const {
    const Part part = at(key);
    const double seconds = part.number();
    part.check(is_time_s(seconds), "a time");
    return seconds;
  }
  double number() const {
    check(json_.is_number(), "a number");
    return json_.get<double>();
  }
  std::string text(const std::string& key) const {
    const Part part = at(key);
    part.check(part.json_.is_string(), "a string");
    return part.json_.get<std::string>();
  }
  /// False if absent.
  bool flag(const std::string& key) const {
    if (!has(key)) return false;
    const Part part = at(key);
    part.check(part.json_.is_boolean(), "true or false");
    return part.json_.get<bool>();
  }
  /// An index below `count`.
  int index(const std::string& key, std::size_t count) const {
    const Part part = at(key);
    part.check(part.json_.is_number_unsigned() && part.json_.get<std::size_t>() < count, "the index of a plane");
    return part.json_.get<int>();
  }
  Polygon polygon(const std::string& key) const {
    Polygon out;
    for (const Part& corner : at(key).parts()) out.push_back(corner.point());
    return out;
  }
  Point2 point(const std::string& key) const { return at(key).point(); }
  Point2 point() const {
    const std::vector<Part> xy = parts();
    check(xy.size() == 2, "[x, y]");
    return {xy[0].place_m(), xy[1].place_m()};
  }

  static constexpr const char* expected = "expected what simulate wrote";

 private:
  void check(bool good, const char* kind) const {
    if (!good) throw BadInput(file_ + ": " + name_ + " is not " + kind + "; " + expected);
  }

  const Json& json_;
  std::string file_, name_;
};

Camber camber_of(const Part& plane) {
  if (!plane.has("camber")) return {};
  const Part camber = plane.at("camber");
  return {camber.number("bend_1_m"), camber.point("crown_m"), camber.point("across")};
}

void take(const Part& file, Truth& truth) {
  truth.start_time_s = file.time_s("start_time_s");
  for (const Part& p : file.at("planes").parts()) {
    truth.planes.push_back({p.text("name"), {p.number("z0_m"), p.number("sx"), p.number("sy"), camber_of(p)}});
  }
  for (const Part& r : file.at("regions").parts()) {
    const int plane = r.index("plane", truth.planes.size());
    truth.regions.push_back({r.text("name"), r.polygon("polygon_m"), plane, r.flag("face")});
  }
  for (const Part& c : file.at("curbs").parts()) {
    truth.curbs.push_back({{c.place_m("x0_m"), c.place_m("y0_m")},
                           {c.place_m("x1_m"), c.place_m("y1_m")},
                           c.number("step0_m"),
                           c.number("step1_m"),
                           c.number("left_z_m"),
                           c.number("right_z_m"),
                           c.number("height_m"),
                           c.text("kind")});
  }
  for (const Part& o : file.at("obstacles").parts()) {
    truth.obstacles.push_back({o.text("name"), o.polygon("polygon_m")});
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
  const Json json = Json::parse(read_whole(path, 1024, "what simulate wrote"), nullptr, false);
  if (json.is_discarded()) throw BadInput(path + ": no JSON, or cut; " + Part::expected);
  Truth truth;
  take({json, path}, truth);
  return truth;
}

}  // namespace curbline::tools
