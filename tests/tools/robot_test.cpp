#include "robot/robot.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <regex>
#include <vector>

#include "formats/can_log.hpp"
#include "formats/carmen.hpp"
#include "formats/cloud.hpp"
#include "formats_support.hpp"

using namespace curbline;
using namespace curbline::tools;
using namespace curbline::tools::testing;

namespace {

const std::string robots = CURBLINE_SOURCE_DIR "/tools/robots/";

Robot parsed(const std::string& text) {
  const TemporaryDirectory dir;
  return read_robot(dir.write("r.toml", text));
}

std::string error_in(const std::string& text) {
  return error_of([&] { parsed(text); });
}

}  // namespace

TEST_CASE("robot: every key has a default") {
  const Robot robot = parsed("");
  CHECK(robot.laser.beams == 1081);
  CHECK(robot.scan_rate_hz == 40.0);
  CHECK(robot.tilt_signal.id == 0x181);
  CHECK(robot.window.rows == 40);
  CHECK(robot.pose.still);
}

TEST_CASE("robot: a laser's model sets its data sheet, keys override it") {
  const Robot robot = parsed("[laser]\nmodel = \"lms-151\"\nmax_range_m = 20\n");
  CHECK(robot.laser.beams == 541);
  CHECK(robot.scan_rate_hz == 50.0);
  CHECK(robot.laser.bearing_step_rad == Approx(std::numbers::pi / 360));
  CHECK(robot.laser.max_range_m == 20.0f);
  CHECK(robot.laser.beam_divergence_rad == 0.015f);
  CHECK(parsed("[laser]\nmodel = \"lms-151\"\nbeam_divergence_rad = 0.01\n").laser.beam_divergence_rad == 0.01f);
  CHECK(parsed("[laser]\nmodel = \"lms-200\"\n").laser.beam_divergence_rad == LaserSettings{}.beam_divergence_rad);
}

TEST_CASE("robot: without a file the firmware has the same laser as a robot file without keys") {
  const LaserSettings ours = parsed("").laser, firmware;
  CHECK(ours.beams == firmware.beams);
  CHECK(ours.first_bearing_rad == Approx(firmware.first_bearing_rad));
  CHECK(ours.bearing_step_rad == Approx(firmware.bearing_step_rad));
  CHECK(ours.beam_interval_s == Approx(firmware.beam_interval_s));
  CHECK(ours.min_range_m == firmware.min_range_m);
  CHECK(ours.max_range_m == firmware.max_range_m);
  CHECK(ours.range_sd_m == firmware.range_sd_m);
  CHECK(ours.bearing_sd_rad == firmware.bearing_sd_rad);
  CHECK(ours.beam_divergence_rad == firmware.beam_divergence_rad);
}

TEST_CASE("robot: beams of every model lie symmetrically about straight ahead") {
  for (const std::string model : {"utm-30lx", "lms-151", "lms-200"}) {
    const LaserSettings laser = parsed("[laser]\nmodel = \"" + model + "\"\n").laser;
    CHECK(laser.first_bearing_rad + 0.5f * static_cast<float>(laser.beams - 1) * laser.bearing_step_rad ==
          Approx(0).margin(1e-5));
  }
}

TEST_CASE("robot: keys are read into the settings of their name") {
  const Robot robot = parsed(R"(
name = "mine"
[tilt]
latency_s = 0.01
[tilt.mount]
z_m = 1.1
[tilt.laser]
pitch_rad = 0.1
[pose]
still = false
[window]
rows = 80
cell_x_m = 0.05
[sweep]
period_s = 2
[simulated]
dropout = 0.1
[tuning.labels]
coupling = 3.5
[tuning.planes]
update = "responsibilities"
)");
  CHECK(robot.name == "mine");
  CHECK(robot.tilt.latency_s == 0.01f);
  CHECK(robot.tilt.T_base_tilt.z_m == 1.1f);
  CHECK(robot.tilt.T_tilt_laser.pitch_rad == 0.1f);
  CHECK_FALSE(robot.pose.still);
  CHECK(robot.window.rows == 80);
  CHECK(robot.window.cell_x_m == 0.05f);
  CHECK(robot.sweep.period_s == 2.0);
  CHECK(robot.simulated.dropout == 0.1);
  CHECK(robot.labels.coupling == 3.5f);
  CHECK(pipeline_settings(robot).planes.update == PlaneUpdate::responsibilities);
}

TEST_CASE("robot: a servo is a preset, the words of a DBC file, or one changed by the other") {
  const auto signal = [](const std::string& keys) { return parsed("[tilt.signal]\n" + keys).tilt_signal; };
  CHECK(signal("servo = \"odrive\"\nnode = 3\n").id == 0x69);
  CHECK(signal("servo = \"vesc\"\nnode = 10\n").id == 0x100A);
  CHECK(signal("servo = \"cubemars\"\nnode = 0x68\n").id == 0x2968);
  CHECK(signal("servo = \"mini-cheetah\"\nmax_bytes = 8\n").max_bytes == 8);
  CHECK(signal("servo = \"mini-cheetah\"\n").min_bytes == 6);
  CHECK(signal("servo = \"robstride\"\nnode = 127\n").id == 0x02007F00);
  const can::Signal cheetah = signal("servo = \"mini-cheetah\"\nid = 7\np_max_rad = 95.5\n");
  CHECK(cheetah.id == 7);
  CHECK(cheetah.offset == -95.5);
  const can::Signal reversed = signal("node = 5\nid = 0x285\nscale = -1.5e-3\n");
  CHECK(reversed.id == 0x285);
  CHECK(reversed.start_bit == 16);
  CHECK(reversed.scale == -1.5e-3);
  const can::Signal own = signal(
      "id = 0x18FF0102\nid_mask = 0x00FFFF00\nextended = true\nstart_bit = 7\nlength = 12\nbyte_order = \"big\"\n"
      "signed = false\nscale = 0.01\noffset = -20\n");
  CHECK((own.extended && own.id_mask == 0xFFFF00 && own.start_bit == 7 && own.length == 12 && !own.is_signed));
  CHECK(own.order == can::ByteOrder::big);
}

TEST_CASE("robot: a drive that samples on SYNC names that frame's id") {
  CHECK_FALSE(parsed("").tilt_sync_id);
  CHECK(parsed("[tilt.signal]\nsync_id = 0x80\n").tilt_sync_id == 0x80);
  CHECK(error_in("[tilt.signal]\nsync_id = 0x800\n") ==
        "r.toml:2: tilt.signal.sync_id is 2048; expected a whole number from 0 to 2047");
  CHECK(error_in("[tilt.signal]\nsync_id = 0x181\n") ==
        "r.toml:2: tilt.signal.sync_id is the signal's own; expected that of the SYNC frame");
}

TEST_CASE("robot: a multiplexed tilt signal has a table for its multiplexor") {
  CHECK_FALSE(parsed("").tilt_signal.multiplexor);
  const std::string signal = "[tilt.signal]\nbyte_order = \"big\"\nstart_bit = 15\n[tilt.signal.multiplexor]\n";
  const auto multiplexor = parsed(signal + "start_bit = 7\nlength = 4\nvalue = 3\n").tilt_signal.multiplexor;
  REQUIRE(multiplexor);
  CHECK(multiplexor->start_bit == 7);
  CHECK(multiplexor->length == 4);
  CHECK(multiplexor->value == 3);
  CHECK(multiplexor->order == can::ByteOrder::big);
  CHECK(parsed(signal + "byte_order = \"little\"\n").tilt_signal.multiplexor->order == can::ByteOrder::little);
  CHECK(error_in(signal + "length = 4\nvalue = 16\n") ==
        "r.toml:6: tilt.signal.multiplexor.value is 16; expected a whole number from 0 to 15");
  CHECK(error_in(signal + "start = 4\n").starts_with("r.toml:5: unknown key tilt.signal.multiplexor.start; expected"));
  CHECK(error_in(signal + "start_bit = 504\nlength = 16\n").starts_with("r.toml:5: tilt.signal.multiplexor.start_bit"));
  CHECK(error_in("[tilt.signal]\nmultiplexor = 3\n") == "r.toml:2: tilt.signal.multiplexor is 3; expected a table");
}

TEST_CASE("robot: bits beyond a frame's 64 bytes are refused") {
  CHECK(error_in("[tilt.signal]\nstart_bit = 490\n").starts_with("r.toml:2: tilt.signal.start_bit does not fit"));
  CHECK(parsed("[tilt.signal]\nstart_bit = 480\n").tilt_signal.start_bit == 480);
}

TEST_CASE("robot: an unknown key is refused by name and line, wherever it stands") {
  CHECK(error_in("nmae = \"x\"\n").starts_with("r.toml:1: unknown key nmae; expected one of "));
  CHECK(error_in("[laser]\n\nmodle = 1\n").starts_with("r.toml:3: unknown key laser.modle; expected one of "));
  CHECK(
      error_in("[tilt.mount]\nx = 1\n").starts_with("r.toml:2: unknown key tilt.mount.x; expected one of pitch_rad, "));
  CHECK(error_in("[tilt.signal]\np_max_rad = 12.5\n").starts_with("r.toml:2: unknown key tilt.signal.p_max_rad"));
  CHECK(error_in("[tuning.labels]\nj = 1\n").starts_with("r.toml:2: unknown key tuning.labels.j"));
  CHECK(error_in("[lazer]\n").starts_with("r.toml:1: unknown key lazer"));
}

const std::vector<std::string> tables_of_numbers{"laser",         "tilt",          "tilt.mount",  "pose",
                                                 "window",        "sweep",         "simulated",   "tuning.segmentation",
                                                 "tuning.planes", "tuning.labels", "tuning.curbs"};

/// The keys that can appear in a table, as the error about an unknown one lists them.
std::vector<std::string> keys_of(const std::string& table) {
  const std::string error = error_in("[" + table + "]\nnone = 0\n"),
                    listed = error.substr(error.find("expected one of") + 15) + ",";
  const std::regex word("([a-z][a-z0-9_]*),");
  std::vector<std::string> keys;
  for (std::sregex_iterator key(listed.begin(), listed.end(), word); key != std::sregex_iterator(); ++key)
    keys.push_back(key->str(1));
  return keys;
}

TEST_CASE("robot: the manual lists the keys that are read, and no others") {
  const std::string manual = read_file(robots + "README.md");
  for (const std::string& table : tables_of_numbers) {
    const std::size_t from = manual.find("\n| `[" + table + "]` |");
    REQUIRE(from != std::string::npos);
    const std::string row = manual.substr(from + 1, manual.find('\n', from + 1) - from - 1);
    const std::vector<std::string> keys = keys_of(table);
    for (const std::string& key : keys) {
      INFO(table << " " << key);
      CHECK((row.find("`" + key + "`") != std::string::npos ||
             manual.find("`[" + table + "." + key + "]`") != std::string::npos));
    }
    const std::regex quoted("`([a-z][a-z0-9_]*)`");
    for (std::sregex_iterator key(row.begin(), row.end(), quoted); key != std::sregex_iterator(); ++key) {
      INFO(table << " " << key->str(1));
      CHECK(std::find(keys.begin(), keys.end(), key->str(1)) != keys.end());
    }
  }
}

TEST_CASE("robot: what lies in a key's range the library takes, to its ends") {
  int ends = 0;
  for (const std::string& table : tables_of_numbers) {
    for (const std::string& key : keys_of(table)) {
      const std::string start = "[" + table + "]\n" + (key == "fixed_tilt_rad" ? "fixed = true\n" : "") + key + " = ";
      const std::string error = error_in(start + "\"x\"\n");
      std::smatch range;
      if (!std::regex_search(error, range, std::regex("number from (\\S+) to (\\S+)$"))) continue;
      for (const std::string& end : {range.str(1), range.str(2)}) {
        INFO(start << end);
        CHECK(error_in(start + end + "\n").find("settings.hpp") == std::string::npos);  // the library's own refusal
        ++ends;
      }
    }
  }
  CHECK(ends > 100);
}

TEST_CASE("robot: whatever the firmware's settings may be, a robot file may say, so that it can be replayed") {
  for (const std::string keys : {"[laser]\nrange_sd_m = 0",
                                 "[laser]\nrange_sd_m = 10",
                                 "[laser]\nbearing_sd_rad = 1",
                                 "[laser]\nbeam_divergence_rad = 1",
                                 "[laser]\nmax_range_m = 1e6",
                                 "[laser]\nfirst_bearing_rad = -6.2831853",
                                 "[laser]\nbeams = 1\nbearing_step_rad = -1",
                                 "[tilt]\nlatency_s = -10",
                                 "[tilt]\nlatency_s = 10",
                                 "[tilt]\nangle_sd_rad = 1",
                                 "[tilt]\nroll_sd_rad = 1",
                                 "[tilt]\npitch_sd_rad = 1",
                                 "[tilt]\nmax_extrapolation_s = 0",
                                 "[tilt]\nmax_gap_s = 1e-4",
                                 "[tilt]\nfixed = true\nfixed_tilt_rad = 3.1415926",
                                 "[tilt.mount]\nyaw_rad = 6.2831853",
                                 "[tilt.laser]\nroll_rad = -6.2831853",
                                 "[tilt.laser]\npitch_rad = 3.2",
                                 "[pose]\nheight_sd_m = 10",
                                 "[pose]\nattitude_sd_rad = 1",
                                 "[pose]\nmax_extrapolation_s = 0",
                                 "[window]\nmax_height_m = 1e30",
                                 "[tuning.curbs]\nmax_step_m = 1000"}) {
    CHECK(error_in(keys + "\n") == "");
  }
}

TEST_CASE("robot: a table without keys leaves what the library has") {
  const Robot robot = parsed("[tuning.segmentation]\n[tuning.planes]\n[tuning.labels]\n[tuning.curbs]\n");
  CHECK(robot.planes.update == PlaneSettings{}.update);
  CHECK(robot.labels.coupling == LabelSettings{}.coupling);
  CHECK_FALSE(robot.labels.max_messages);
  CHECK(robot.curbs.max_step_m == CurbSettings{}.max_step_m);
  CHECK(robot.segmentation.leaf_scale == SegmentationSettings{}.leaf_scale);
}

TEST_CASE("robot: a wrong type is refused with what was expected") {
  CHECK(error_in("[laser]\nbeams = 1081.0\n") ==
        "r.toml:2: laser.beams is 1081.0; expected a whole number from 1 to 2881");
  CHECK(error_in("[laser]\nbeams = 100000\n") ==
        "r.toml:2: laser.beams is 100000; expected a whole number from 1 to 2881");
  CHECK(error_in("[laser]\nmax_range_m = 1e300\n").starts_with("r.toml:2: laser.max_range_m is 1e+300; expected"));
  CHECK(error_in("[laser]\nrange_sd_m = \"1 cm\"\n") ==
        "r.toml:2: laser.range_sd_m is '1 cm'; expected a number from 0 to 10");
  CHECK(error_in("[tilt]\nfixed = 1\n") == "r.toml:2: tilt.fixed is 1; expected true or false");
  CHECK(error_in("[tilt]\nlatency_s = true\n") ==
        "r.toml:2: tilt.latency_s is of type boolean; expected a number from -10 to 10");
  CHECK(error_in("name = 3\n") == "r.toml:1: name is 3; expected a string");
  CHECK(error_in("window = 3\n") == "r.toml:1: window is 3; expected a table");
  CHECK(error_in("[[window]]\nrows = 40\n") == "r.toml:1: window is of type array; expected a table");
}

TEST_CASE("robot: an angle for a fixed tilt wants to be told whether the tilt is fixed") {
  CHECK(error_in("[tilt]\nlatency_s = 0\nfixed_tilt_rad = 0.5\n") ==
        "r.toml:3: tilt.fixed_tilt_rad is without fixed; expected fixed = true or false beside it");
  CHECK_FALSE(parsed("[tilt]\nfixed = false\nfixed_tilt_rad = 0.5\n").tilt.fixed);
}

TEST_CASE("robot: values out of range are refused with the range") {
  CHECK(error_in("[laser]\nbeams = 0\n") == "r.toml:2: laser.beams is 0; expected a whole number from 1 to 2881");
  CHECK(error_in("[laser]\nbeams = 2882\n").starts_with("r.toml:2: laser.beams is 2882; expected"));
  CHECK(error_in("[laser]\nrange_sd_m = nan\n").starts_with("r.toml:2: laser.range_sd_m is nan; expected"));
  CHECK(error_in("[window]\nrows = 42\n") == "r.toml:2: window.rows is 42; expected a multiple of 4");
  CHECK(error_in("[window]\ncell_x_m = -0.1\n").starts_with("r.toml:2: window.cell_x_m is -0.1; expected"));
  CHECK(error_in("[window]\norigin_x_m = 0\norigin_y_m = 2e5\n")
            .starts_with("r.toml:3: window.origin_y_m is 2e+05; expected a number from "));
  CHECK(error_in("[laser]\nmodel = \"lidar\"\n") ==
        "r.toml:2: laser.model is \"lidar\"; expected utm-30lx, lms-151 or lms-200");
  CHECK(error_in("[laser]\nbearing_step_rad = 0\n").starts_with("r.toml:2: laser.bearing_step_rad is 0"));
  CHECK(error_in("[laser]\nbearing_step_rad = 0.1\n").starts_with("r.toml:2: laser.bearing_step_rad times the beams"));
  CHECK(error_in("[laser]\nscan_rate_hz = 100\n").starts_with("r.toml:1: laser.beam_interval_s times the beams"));
  CHECK(error_in("[laser]\nmin_range_m = 50\n")
            .starts_with("r.toml:1: laser.max_range_m is not above min_range_m; expected"));
  CHECK(error_in("[simulated]\npose_jump_every_s = 1e-9\n") ==
        "r.toml:2: simulated.pose_jump_every_s is below 1e-04; expected 0, never, or no oftener than poses may come");
  CHECK(error_in("[sweep]\nfrom_rad = 2\n").starts_with("r.toml:1: sweep.to_rad is not above from_rad; expected"));
  CHECK(error_in("[tilt.signal]\nservo = \"esc\"\n")
            .starts_with("r.toml:2: tilt.signal.servo is \"esc\"; expected cia402, "));
  CHECK(error_in("[tilt.signal]\nnode = 128\n") ==
        "r.toml:2: tilt.signal.node is 128; expected a whole number from 1 to 127");
  CHECK(error_in("[tilt.signal]\nid = 0x1810\n").starts_with("r.toml:2: tilt.signal.id is too large"));
  CHECK(error_in("[tilt.signal]\nscale = 0\n").starts_with("r.toml:2: tilt.signal.scale is 0"));
  CHECK(
      error_in("[tilt.signal]\nfloat = true\nlength = 16\n").starts_with("r.toml:3: tilt.signal.length does not fit"));
  CHECK(
      error_in("[tilt.signal]\nbyte_order = \"intel\"\n").starts_with("r.toml:2: tilt.signal.byte_order is \"intel\""));
}

TEST_CASE("robot: line ends and other control characters of a string or a key leave the message one line") {
  CHECK(error_in("[laser]\nmodel = \"a\\nb\\u001b[2J\"\n") ==
        "r.toml:2: laser.model is \"a\\nb\\x1b[2J\"; expected utm-30lx, lms-151 or lms-200");
  for (const std::string key : {"[tilt.signal]\nservo", "[tilt.signal]\nbyte_order", "[tuning.planes]\nupdate"})
    CHECK(error_in(key + " = \"a\\nb\"\n").find(" is \"a\\nb\"; expected ") != std::string::npos);
  CHECK(error_in("[laser]\nbeams = \"a\\nb\"\n").find("a\\nb") != std::string::npos);
  CHECK(error_in("\"a\\nb\" = 1\n").starts_with("r.toml:1: unknown key a\\nb; expected one of "));
}

TEST_CASE("robot: a key or a word of any length leaves the message short, and one of any depth is refused") {
  const std::string huge(900'000, 'k');
  for (const std::string& text :
       {huge + " = 1\n", huge + " = 1\n" + huge + " = 2\n", "[laser]\nmodel = \"" + huge + "\"\n",
        "[tilt.signal]\nservo = \"" + huge + "\"\n", "[" + huge}) {
    const std::string error = error_in(text);
    CHECK(error.starts_with("r.toml:"));
    CHECK(error.size() < 400);
  }
  std::string deep = "k";
  for (int i = 0; i < 200'000; ++i) deep += ".k";
  for (const std::string& text : {deep + " = 1\n", "\n[" + deep + "]\n", "a = {" + deep + " = 1}\n"}) {
    const std::string error = error_in(text);
    INFO(error);
    CHECK(error.find("deep") != std::string::npos);
    CHECK(error.starts_with(text[0] == '\n' ? "r.toml:2: " : "r.toml:1: "));
  }
  const std::string dots(300, '.');
  CHECK(parsed("# " + dots + "\nname = \"" + dots + "\"\n").name.size() == 300);
}

TEST_CASE("robot: a key after a string of any kind has its own depth, the string's contents are not keys") {
  std::string deep = "k";
  for (int i = 0; i < 200'000; ++i) deep += ".k";
  const std::vector<std::string> strings{R"("")",       R"("\\")",     R"("\"#")",        R"("'")",
                                         "''",          R"('\')",      R"('"')",  // single-line, then multi-line
                                         R"("""""")",   R"(""""""")",  R"("""""""")",     R"("""" "" """)",
                                         R"("""\"""")", R"("""\\""")", "\"\"\"\nx\"\"\"", "\"\"\"\\\n#\"\"\"",
                                         "''''''",      "'''''''",     "''''''''",        R"('''\''')",
                                         "'''\n\"\n'''"};
  for (const std::string& before : strings) {
    const std::string error = error_in("a = {b = " + before + ", " + deep + " = 1}\n");
    INFO(before << "\n" << error);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    CHECK(error.starts_with("r.toml:" + std::to_string(line) + ": a key is too deep"));
  }
  CHECK(error_in("a = {\"\"." + deep + " = 1}\n").starts_with("r.toml:1: a key is too deep"));
  CHECK(error_in("# it's \"\"\"\n" + deep + " = 1\n").starts_with("r.toml:2: a key is too deep"));
  const std::string dots(300, '.');
  for (const std::string quotes : {"\"\"\"", "'''"}) {
    CHECK(parsed("name = " + quotes + "\n" + dots + "\n" + quotes + "\n").name == dots + "\n");
    CHECK(parsed("name = " + quotes + quotes[0] + dots + quotes + quotes[0] + "  # " + dots + "\n").name ==
          quotes[0] + dots + quotes[0]);
    CHECK(error_in("name = " + quotes + "\n" + dots + "\n" + quotes + "\nbeams = 1\n")
              .starts_with("r.toml:4: unknown key"));
    CHECK(error_in("name = " + quotes + dots).starts_with("r.toml:1: "));
  }
  CHECK(error_in("name = \"" + dots + "\nbeams = 1\n").starts_with("r.toml:1: "));
}

TEST_CASE("robot: what is no TOML, or cannot be read, is refused") {
  const TemporaryDirectory dir;
  CHECK(error_in("[laser\n").starts_with("r.toml:1: "));
  CHECK(error_in("[laser]\nbeams = 1\nbeams = 2\n").starts_with("r.toml:3: "));
  CHECK(error_of([&] { read_robot(dir.path("none.toml")); }).starts_with("none.toml: cannot be read"));
  CHECK(error_of([&] { read_robot(dir.path(".")); }).starts_with(".: cannot be read"));
  CHECK(error_of([&] { read_robot("/dev/zero"); }).find("longer than 1 MiB") != std::string::npos);
}

TEST_CASE("robot: the robots that ship are good") {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(robots)) {
    if (entry.path().extension() != ".toml") continue;
    INFO(entry.path());
    CHECK(error_of([&] { read_robot(entry.path().string()); }).empty());
    CHECK(read_robot(entry.path().string()).name + ".toml" == entry.path().filename());
    ++count;
  }
  CHECK(count == 5);
}

TEST_CASE("robot: damaged descriptions are read or refused, and nothing worse") {
  survive_damage(
      read_file(robots + "clausius.toml"), "r.toml", [](const std::string& path) { read_robot(path); }, 3000);
}

TEST_CASE("robot: clausius.toml turns the raw stream into the published cloud, point by point") {
  const std::string data = CURBLINE_SOURCE_DIR "/../shared/data/clausius/";
  if (!std::filesystem::exists(data + "scan-03.xyz")) {
    WARN("SKIPPED: no data set at ../shared/data/clausius");
    return;
  }
  const Robot robot = read_robot(robots + "clausius.toml");
  const std::vector<Point3> cloud = read_cloud(data + "scan-03.xyz");
  CarmenReader scans(data + "scan-03.carmen");
  CanLogReader frames(data + "scan-03.candump");
  std::size_t next = 0;
  double worst_m = 0.0, worst_far_m = 0.0;  // far: beyond 10 m the cloud, with four digits, is in centimetres
  while (const auto scan = scans.next()) {
    check_geometry(*scan, robot.laser, scans.path(), scans.line());
    auto frame = frames.next();  // one frame has the line's own time
    while (frame && frame->time_ns < scan->time_ns) frame = frames.next();
    REQUIRE((frame && frame->time_ns == scan->time_ns));
    const auto tilt = decode(robot.tilt_signal, *frame);
    REQUIRE(tilt);
    for (std::size_t i = 0; i < scan->ranges_m.size(); ++i) {
      if (std::isnan(scan->ranges_m[i])) continue;
      const double bearing = static_cast<double>(robot.laser.first_bearing_rad) +
                             static_cast<double>(i) * static_cast<double>(robot.laser.bearing_step_rad);
      const double ahead = static_cast<double>(scan->ranges_m[i]) * std::cos(bearing);
      const double left = static_cast<double>(scan->ranges_m[i]) * std::sin(bearing);
      const double up = static_cast<double>(robot.tilt.T_tilt_laser.z_m);
      const Point3 p{ahead * std::cos(*tilt) + up * std::sin(*tilt), left,
                     static_cast<double>(robot.tilt.T_base_tilt.z_m) - ahead * std::sin(*tilt) + up * std::cos(*tilt)};
      REQUIRE(next < cloud.size());
      const Point3& q = cloud[next++];
      double& worst = scan->ranges_m[i] < 10.0f ? worst_m : worst_far_m;
      worst = std::max({worst, std::abs(p.x - q.x), std::abs(p.y - q.y), std::abs(p.z - q.z)});
    }
  }
  CHECK(next == cloud.size());
  CHECK(worst_m < 1e-3);
  CHECK(worst_far_m < 1e-2);
}
