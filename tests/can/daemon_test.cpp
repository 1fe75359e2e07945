// The daemon on the kernel's CAN: it gives the same curbs as replay of the logs, and survives what may happen on a bus.
#include <linux/can/error.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>

#include "curbline/can/curb_frames.hpp"
#include "formats/can_log.hpp"
#include "formats/csv.hpp"
#include "formats/trajectory.hpp"
#include "service.hpp"

namespace curbline::tools::testing {
namespace {

using namespace std::chrono_literals;
using socketcan::SocketCan;

const Recording& recording() {
  static const Recording made("curb_above_below", "utm30lx", {"--duration", "6"});
  return made;
}

Words daemon_words(const Words& more = {}) {
  return Words{
             "--can", "vcan0", "--scans", recording().path("scans.carmen"), "--robot", recording().path("robot.toml")} +
         more;
}

/// The curbs of an undisturbed run.
const std::vector<nlohmann::json>& undisturbed() {
  static const std::vector<nlohmann::json> curbs = replayed_curbs(recording().replay());
  return curbs;
}

/// The last curbs of replay.
nlohmann::json end_of(const Recording& recording) {
  const Outcome outcome = curbline(recording.replay() + Words{"--curbs", recording.path("curbs.csv")});
  REQUIRE(outcome.status == 0);
  nlohmann::json curbs = nlohmann::json::array();
  for (const MapCurb& c : read_curbs(recording.path("curbs.csv"))) {
    curbs.push_back({{"x0_m", c.x0_m},
                     {"y0_m", c.y0_m},
                     {"x1_m", c.x1_m},
                     {"y1_m", c.y1_m},
                     {"height_m", c.height_m},
                     {"kind", c.kind}});
  }
  REQUIRE(!curbs.empty());
  return curbs;
}

/// The last status of a run that ended by itself and without an error.
nlohmann::json status_of(const Outcome& outcome) {
  INFO("standard error: " << outcome.err);
  REQUIRE(outcome.status == 0);
  const nlohmann::json status = nlohmann::json::parse(outcome.out).at("status");
  CHECK(status.at("heap_calls").at("before_start") > 100);  // the trap works
  CHECK(status.at("heap_calls").at("since_start") == 0);
  return status;
}

can::Frame first_frame_of(const Recording& recording) {
  const auto frame = CanLogReader(recording.path("can.log")).next();
  REQUIRE(frame);
  return *frame;
}

void send_well(SocketCan& bus, const can::Frame& frame) {
  REQUIRE(bus.send(frame) == socketcan::Status::ok);
}

void send_each(SocketCan& bus, const can::Frame& frame, double) {
  send_well(bus, frame);
}

/// Plays the recording's log through `send`. Returns the client's lines and how the daemon ended.
struct Drive {
  std::vector<nlohmann::json> lines;
  Outcome outcome;
};
Drive drive(const Send& send) {
  Service service(daemon_words());
  play(recording().path("can.log"), send);
  Drive drive;
  drive.outcome = service.end();
  drive.lines = service.lines();
  return drive;
}

TEST_CASE("daemon: beside canplayer it gives the curbs of replay, every one, and nothing is taken from the heap",
          "[daemon]") {
  SocketCan receiver;
  const std::array ids{socketcan::Filter{can::curb_ahead_id, 0x7FE, false}};
  REQUIRE(receiver.open("vcan0", ids) == socketcan::Status::ok);
  Service service(daemon_words({"--can-out"}));
  CHECK(std::system(("canplayer -I '" + recording().path("can.log") + "' vcan0=can0").c_str()) == 0);
  const Outcome outcome = service.end();
  const nlohmann::json status = status_of(outcome);
  check_same(distinct_curbs(service.lines()), undisturbed());
  CHECK(undisturbed().size() > 20);
  const auto scan_lines = status.at("pipeline").at("lines").get<int>();
  CHECK(scan_lines == 240);
  CHECK(status.at("pipeline").at("lines_dropped") == 0);
  CHECK(status.at("scans").at("overdue") == 0);
  CHECK(status.at("microseconds").at("pipeline").at("samples") == scan_lines);
  CHECK(status.at("microseconds").at("tilt_frame_to_curbs").at("samples") > 0);
  CHECK(times_said(outcome.err, "ready") == 1);
  CHECK_FALSE(std::filesystem::exists(service.socket()));

  const auto frames = socketcan::testing::receive_all(receiver);
  const int before = 2 * scan_lines - static_cast<int>(frames.size());  // the sweep begins beyond the window
  CHECK(before > 0);
  REQUIRE(before < 20);
  std::optional<CurbAhead> ahead;
  can::CurbStatus last;
  REQUIRE(can::read_curb_ahead(frames[frames.size() - 2], ahead));
  REQUIRE(can::read_curb_status(frames.back(), last));
  CHECK(last.counter == (scan_lines - before - 1) % 256);
  CHECK(last.curbs == last_curbs(service.lines()).size());
  REQUIRE(ahead);
  CHECK(ahead->kind == CurbKind::step_down);
  CHECK(double{ahead->distance_m} == Approx(1.1).margin(0.05));
  CHECK(double{ahead->height_m} == Approx(-0.12).margin(0.01));
}

TEST_CASE("daemon: a flood of other ids, requests and error messages changes no curb, and errors are told once",
          "[daemon]") {
  const Drive flooded = drive([](SocketCan& bus, const can::Frame& frame, double) {
    for (std::uint32_t i = 0; i < 16; ++i) send_well(bus, socketcan::testing::frame_of(0x200 + i, i % 2 == 0));
    can::Frame request = frame;
    request.remote = true;
    send_well(bus, request);
    can::Frame twin = frame;
    twin.extended = true;
    send_well(bus, twin);
    can_frame error{};
    error.can_id = CAN_ERR_FLAG | CAN_ERR_PROT | CAN_ERR_BUSERROR;
    error.len = CAN_ERR_DLC;
    for (int i = 0; i < 4; ++i) REQUIRE(::write(bus.descriptor(), &error, sizeof error) == sizeof error);
    send_well(bus, frame);
  });
  const nlohmann::json status = status_of(flooded.outcome);
  check_same(distinct_curbs(flooded.lines), undisturbed());
  CHECK(status.at("can").at("bus_errors") == 4 * status.at("can").at("frames").get<int>());
  CHECK(status.at("tilt").at("others") == 0);  // the kernel filters them out
  CHECK(times_said(flooded.outcome.err, "errors on the CAN bus") == 1);
}

TEST_CASE("daemon: what the controller reports is told in its own words, and bus-off is a state until it is back",
          "[daemon]") {
  Service service(daemon_words());
  SocketCan controller;
  REQUIRE(controller.open("vcan0", {}) == socketcan::Status::ok);
  const auto state_is = [&](const char* state) {
    return service.gives([state](const nlohmann::json& line) {
      return line.contains("status") && line.at("status").at("state") == state;
    });
  };
  const auto report = [&](canid_t what, std::uint8_t data, const std::string& words) {
    socketcan::testing::say_error(controller, what, data);
    INFO(words);
    CHECK(service.says(words + " (1 so far)\n"));
  };
  report(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW, "the CAN controller lost frames");
  report(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE, "the CAN controller is error-passive");
  report(CAN_ERR_ACK, 0, "errors on the CAN bus");
  report(CAN_ERR_BUSOFF, 0, "the CAN controller has left the bus (bus-off)");
  CHECK(state_is("bus_off"));
  report(CAN_ERR_RESTARTED, 0, "the CAN controller is back on the bus");
  service.signal(SIGTERM);
  const nlohmann::json status = status_of(service.end());
  CHECK(status.at("state") == "tilt_missing");
  CHECK(status.at("can").at("bus") == "active");
}

TEST_CASE(
    "daemon: an interface that is cut and comes back is told once, and the curbs are those of the frames that came",
    "[daemon]") {
  std::ofstream came(recording().path("came.log"));
  bool down = false;
  const Drive cut = drive([&](SocketCan& bus, const can::Frame& frame, double since_s) {
    const bool wanted_down = since_s > 2.0 && since_s < 2.4;
    if (wanted_down != down) REQUIRE(vcan::set_link("vcan0", !wanted_down) == 0);
    down = wanted_down;
    if (bus.send(frame) == socketcan::Status::ok) write_can_frame(came, frame, "can0");
  });
  came.close();
  const nlohmann::json status = status_of(cut.outcome);
  CHECK(status.at("can").at("times_down") == 1);
  CHECK(status.at("can").at("times_back") == 1);
  CHECK(times_said(cut.outcome.err, "the CAN interface is down") == 1);
  CHECK(times_said(cut.outcome.err, "the CAN interface is up again") == 1);
  check_same(distinct_curbs(cut.lines), replayed_curbs(recording().replay("can", recording().path("came.log"))));
  check_alike(last_curbs(cut.lines), end_of(recording()));
}

/// A scene in which a robot drives toward a curb of 10 cm, from 3 m away to 1 m.
std::string kerb_ahead() {
  static const TemporaryDirectory directory;
  return directory.write("kerb.toml",
                         "[ground]\nz = 0.0\n[[region]]\nrectangle = [3.0, -12.0, 14.0, 12.0]\nz = 0.1\n"
                         "[robot]\npath = [[0.0, 0.0], [2.0, 0.0]]\nspeed = 0.3\n");
}

const Recording& driven() {
  static const Recording made(kerb_ahead(), "utm30lx");
  return made;
}

std::string make_fifo(const Recording& recording) {
  const std::string path = recording.path("fifo");
  REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
  return path;
}

/// Writes a recording's poses into a FIFO as time passes.
class Localisation {
 public:
  Localisation(const std::string& fifo, const Recording& recording)
      : fifo_(fifo), poses_(recording.path("poses.tum")), next_(poses_.next()) {
    std::signal(SIGPIPE, SIG_IGN);  // the daemon ends with its log of scan lines, before the poses do
  }
  void say_nothing_until(std::int64_t time_ns) {
    while (next_ && next_->time_ns <= time_ns) next_ = poses_.next();
  }
  void write_until(std::int64_t time_ns) {
    for (; next_ && next_->time_ns <= time_ns; next_ = poses_.next()) write_trajectory_pose(fifo_, *next_);
    fifo_.flush();
  }
  void write(const std::string& text) { fifo_ << text << std::flush; }

 private:
  std::ofstream fifo_;
  TrajectoryReader poses_;
  std::optional<TrajectoryPose> next_;
};

Words driven_words(const std::string& poses) {
  return {"--can",   "vcan0", "--scans", driven().path("scans.carmen"), "--robot", driven().path("robot.toml"),
          "--poses", poses};
}

int connect_late(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy(path.begin(), path.end(), address.sun_path);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  REQUIRE(::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  return socket;
}

TEST_CASE("daemon: a client that comes late has the status and all curbs at once, though nothing changes", "[daemon]") {
  Service service(daemon_words());
  int late = -1;
  play(recording().path("can.log"), [&](SocketCan& bus, const can::Frame& frame, double since_s) {
    if (since_s < 3.5) send_well(bus, frame);
    if (since_s > 5.0 && late < 0) late = connect_late(service.socket());  // lines wait a second for their tilt
  });
  status_of(service.end());
  std::string text;
  std::array<char, 65536> some{};
  for (ssize_t got; (got = ::read(late, some.data(), some.size())) > 0;)
    text.append(some.data(), static_cast<std::size_t>(got));
  ::close(late);
  const Words lines = lines_of(text);
  REQUIRE(lines.size() >= 2);
  CHECK(nlohmann::json::parse(lines[0]).contains("status"));
  REQUIRE(nlohmann::json::parse(lines[1]).contains("curbs"));
  CHECK(nlohmann::json::parse(lines[1]).at("curbs") == last_curbs(service.lines()));
  CHECK(last_curbs(service.lines()).size() > 0);
}

TEST_CASE("daemon: a curb beside the way is no curb ahead on CAN", "[daemon]") {
  const TemporaryDirectory directory;
  const Recording beside(directory.write("beside.toml",
                                         "[ground]\nz = 0.0\n[[region]]\n"
                                         "rectangle = [-2.0, 0.7, 14.0, 12.0]\nz = 0.1\n"),
                         "utm30lx", {"--duration", "4"});
  SocketCan receiver;
  const std::array ids{socketcan::Filter{can::curb_ahead_id, 0x7FF, false}};
  REQUIRE(receiver.open("vcan0", ids) == socketcan::Status::ok);
  Service service(
      {"--can", "vcan0", "--scans", beside.path("scans.carmen"), "--robot", beside.path("robot.toml"), "--can-out"});
  play(beside.path("can.log"), send_each);
  CHECK(status_of(service.end()).at("pipeline").at("curbs") == 1);
  const auto frames = socketcan::testing::receive_all(receiver);
  CHECK(frames.size() > 100);
  for (const can::Frame& frame : frames) {
    std::optional<CurbAhead> ahead;
    REQUIRE(can::read_curb_ahead(frame, ahead));
    CHECK_FALSE(ahead);
  }
}

TEST_CASE("daemon: a robot that drives through a log has the curbs of replay, every one", "[daemon]") {
  Service service(driven_words(driven().path("poses.tum")));
  std::this_thread::sleep_for(800ms);  // the log begins with the first frame
  play(driven().path("can.log"), send_each);
  const Outcome outcome = service.end();
  const nlohmann::json status = status_of(outcome);
  check_same(distinct_curbs(service.lines()), replayed_curbs(driven().replay()));
  CHECK(last_curbs(service.lines()).size() > 0);
  CHECK(status.at("pipeline").at("lines_dropped") == 0);
  CHECK(status.at("poses").at("state") == "ok");
  CHECK(status.at("poses").at("taken") > 100);
  CHECK(times_said(outcome.err, "pose") == 0);
}

TEST_CASE("daemon: lines that wait for poses keep their tilt, at any rate of the servo", "[daemon]") {
  const TemporaryDirectory directory;
  std::string robot = read_file(shipped_robot("utm30lx"));
  for (const auto& [key, value] : {std::pair{"tilt_rate_hz = 100.0", "tilt_rate_hz = 500.0"},
                                   std::pair{"pose_rate_hz = 50.0", "pose_rate_hz = 5.0"}}) {
    const std::size_t at = robot.find(key);
    REQUIRE(at != std::string::npos);
    robot.replace(at, std::string(key).size(), value);
  }
  const Recording fast(kerb_ahead(), directory.write("fast.toml", robot), {"--duration", "3"});
  const std::string fifo = make_fifo(fast);
  Service service(
      {"--can", "vcan0", "--scans", fast.path("scans.carmen"), "--robot", fast.path("robot.toml"), "--poses", fifo});
  Localisation localisation(fifo, fast);
  play(fast.path("can.log"), [&](SocketCan& bus, const can::Frame& frame, double) {
    localisation.write_until(frame.time_ns);
    send_well(bus, frame);
  });
  const nlohmann::json pipeline = status_of(service.end()).at("pipeline");
  CHECK(pipeline.at("lines") > 60);
  CHECK(pipeline.at("beams_without_tilt") == 0);
  CHECK(pipeline.at("beams_extrapolated") == 0);
}

TEST_CASE("daemon: poses from a FIFO place the curbs of a moving robot, damage and silence are reported once",
          "[daemon]") {
  const std::string fifo = make_fifo(driven());
  SocketCan receiver;
  const std::array ids{socketcan::Filter{can::curb_ahead_id, 0x7FE, false}};
  REQUIRE(receiver.open("vcan0", ids) == socketcan::Status::ok);
  Service service(driven_words(fifo) + Words{"--can-out"});
  CHECK(service.says("no pose since the start; expected lines of time tx ty tz qx qy qz qw from " + fifo + "\n"));
  Localisation localisation(fifo, driven());
  localisation.write("damaged\n");
  play(driven().path("can.log"), [&](SocketCan& bus, const can::Frame& frame, double since_s) {
    if (since_s > 3.0 && since_s < 3.8) {
      localisation.say_nothing_until(frame.time_ns);
    } else {
      localisation.write_until(frame.time_ns);
    }
    send_well(bus, frame);
  });
  const Outcome outcome = service.end();
  const nlohmann::json status = status_of(outcome);
  const nlohmann::json curbs = last_curbs(service.lines());
  INFO(curbs);
  REQUIRE(curbs.size() == 1);
  CHECK(curbs[0].at("kind") == "step_up");
  CHECK(curbs[0].at("x0_m").get<double>() == Approx(3.0).margin(0.05));  // in the map
  CHECK(curbs[0].at("height_m").get<double>() == Approx(0.1).margin(0.01));
  std::optional<CurbAhead> ahead, last;
  for (const can::Frame& frame : socketcan::testing::receive_all(receiver)) {
    if (can::read_curb_ahead(frame, ahead)) last = ahead;
  }
  REQUIRE(last);
  CHECK(double{last->distance_m} == Approx(1.0).margin(0.05));  // ahead of the robot
  CHECK(status.at("poses").at("times_lost") == 1);
  CHECK(status.at("poses").at("damaged") == 1);
  CHECK(times_said(outcome.err, "no pose since the start") == 1);
  CHECK(times_said(outcome.err, "the localisation gives poses\n") == 1);
  CHECK(times_said(outcome.err, "lines that are no poses, passed over (1 so far)") == 1);
  CHECK(times_said(outcome.err, "the localisation is silent") == 1);
  CHECK(times_said(outcome.err, "the localisation gives poses again") == 1);
}

TEST_CASE("daemon: a robot with a fixed tilt reports a good tilt on the bus", "[daemon]") {
  SocketCan receiver;
  const std::array ids{socketcan::Filter{can::curb_ahead_id, 0x7FE, false}};
  REQUIRE(receiver.open("vcan0", ids) == socketcan::Status::ok);
  const TemporaryDirectory directory;
  const std::string fixed = directory.write("fixed.toml", "[tilt]\nfixed = true\nfixed_tilt_rad = 0.5\n");
  Service service({"--can", "vcan0", "--can-out", "--scans", recording().path("scans.carmen"), "--robot", fixed});
  status_of(service.end());
  const auto frames = socketcan::testing::receive_all(receiver);
  CHECK(frames.size() > 200);
  for (const can::Frame& frame : frames) {
    can::CurbStatus told;
    if (can::read_curb_status(frame, told)) CHECK(told.tilt == SourceState::ok);
  }
}

/// A scan line of the log whose laser is covered, or sees a wall all around it.
std::string sees(const std::string& line, bool covered) {
  std::istringstream words(line);
  std::string out, word;
  for (int field = 0; words >> word; ++field) {
    const bool range = field >= 9 && field < 9 + 1081;
    out += (field > 0 ? " " : "") + (!range ? word : covered ? "0" : "2.3");
  }
  return out + "\n";
}

TEST_CASE("daemon: a covered laser is a state, told once, and its lines do not make the curb ahead pass for fresh",
          "[daemon]") {
  SocketCan receiver;
  const std::array ids{socketcan::Filter{can::curb_ahead_id, 0x7FE, false}};
  REQUIRE(receiver.open("vcan0", ids) == socketcan::Status::ok);
  const TemporaryDirectory directory;
  const std::string fixed = directory.write("fixed.toml", "[tilt]\nfixed = true\nfixed_tilt_rad = 0.5\n");
  std::string scans;
  int lines = 0;
  const auto is_covered = [](int line) { return line >= 80 && line < 160; };  // for 2 s
  for (const std::string& line : lines_of(read_file(recording().path("scans.carmen"))))
    scans += sees(line, is_covered(lines++));
  REQUIRE(lines == 240);
  Service service({"--can", "vcan0", "--can-out", "--scans", directory.write("scans", scans), "--robot", fixed});
  CHECK(service.gives([](const nlohmann::json& line) {
    return line.contains("status") && line.at("status").at("state") == "laser_blind";
  }));
  const Outcome outcome = service.end();
  const nlohmann::json status = status_of(outcome);
  CHECK(status.at("pipeline").at("lines") == 240);
  CHECK(status.at("sight").at("state") == "ok");
  CHECK(status.at("sight").at("times_lost") == 1);
  CHECK(times_said(outcome.err, "the laser is blind: covered, or it looks beside the window\n") == 1);
  CHECK(times_said(outcome.err, "the laser sees again\n") == 1);
  int told = 0;
  std::uint8_t counter = 255;
  std::optional<CurbAhead> ahead;
  can::CurbStatus read;
  for (const can::Frame& frame : socketcan::testing::receive_all(receiver)) {
    if (can::read_curb_ahead(frame, ahead)) {
      CHECK_FALSE(is_covered(told));
      ++counter;
    } else if (can::read_curb_status(frame, read)) {
      CHECK(read.counter == counter);
      ++told;
    }
  }
  CHECK(told == 240);
  CHECK(counter == 240 - 80 - 1);
}

TEST_CASE("daemon: a CAN interface that a fixed-tilt robot does not need is reported", "[daemon]") {
  const TemporaryDirectory directory;
  const std::string fixed = directory.write("fixed.toml", "[tilt]\nfixed = true\nfixed_tilt_rad = 0.5\n");
  Service service({"--can", "vcan0", "--scans", recording().path("scans.carmen"), "--robot", fixed});
  CHECK(service.says("the tilt is fixed: nothing is read from --can\n"));
  status_of(service.end());
}

TEST_CASE("daemon: a servo that falls silent is an error state, told once, on the socket and on CAN, until it reports",
          "[daemon]") {
  SocketCan receiver;
  const std::array ids{socketcan::Filter{can::curb_ahead_id, 0x7FE, false}};
  REQUIRE(receiver.open("vcan0", ids) == socketcan::Status::ok);
  Service service(daemon_words({"--can-out"}));
  const auto state_is = [](const char* state) {
    return [state](const nlohmann::json& line) {
      return line.contains("status") && line.at("status").at("state") == state;
    };
  };
  CHECK(service.gives(state_is("tilt_missing")));
  CHECK(
      service.says("no tilt frame since the start; expected id 0x181 of 11 bits on vcan0, with which the log of scan "
                   "lines begins\n"));
  play(recording().path("can.log"), [&](SocketCan& bus, const can::Frame& frame, double since_s) {
    if (since_s > 1.0 && since_s < 2.8) return;
    send_well(bus, frame);
  });
  const Outcome outcome = service.end();
  const nlohmann::json status = status_of(outcome);
  CHECK(service.gives(state_is("tilt_stale")));
  CHECK(status.at("tilt").at("times_lost") == 1);
  CHECK(status.at("tilt").at("state") == "ok");
  CHECK(status.at("tilt").at("longest_silence_s") > 1.7);
  CHECK(status.at("pipeline").at("lines_dropped") > 30);
  CHECK(times_said(outcome.err, "no tilt frame since the start") == 1);
  CHECK(times_said(outcome.err, "the tilt servo is silent") == 1);
  CHECK(times_said(outcome.err, "the tilt servo reports again") == 1);
  std::set<SourceState> sent;
  std::optional<CurbAhead> ahead;
  std::uint8_t counter = 255;
  int told = 0, dropped = 0;
  bool renewed = false;
  for (const can::Frame& frame : socketcan::testing::receive_all(receiver)) {
    if (can::read_curb_ahead(frame, ahead)) {
      renewed = true;
      continue;
    }
    can::CurbStatus read;
    REQUIRE(can::read_curb_status(frame, read));
    sent.insert(read.tilt);
    if (renewed || told > 0) ++(renewed ? told : dropped);  // before, no line has seen the window
    counter = static_cast<std::uint8_t>(counter + renewed);
    CHECK(read.counter == counter);  // it does not advance with a dropped line
    renewed = false;
  }
  CHECK(told > 100);
  CHECK(dropped >= status.at("pipeline").at("lines_dropped").get<int>());
  CHECK(sent.count(SourceState::stale) == 1);
  check_alike(last_curbs(service.lines()), end_of(recording()));
}

TEST_CASE("daemon: an encoder that is stuck is a state, told once, and on CAN, until it moves again", "[daemon]") {
  SocketCan receiver;
  const std::array ids{socketcan::Filter{can::curb_status_id, 0x7FF, false}};
  REQUIRE(receiver.open("vcan0", ids) == socketcan::Status::ok);
  const TemporaryDirectory directory;
  const std::string brisk = directory.write("brisk.toml", "[sweep]\nperiod_s = 1.0\n");
  Service service({"--can", "vcan0", "--can-out", "--scans", recording().path("scans.carmen"), "--robot", brisk});
  can::Frame stuck;
  play(recording().path("can.log"), [&](SocketCan& bus, const can::Frame& frame, double since_s) {
    if (since_s < 1.0) stuck = frame;
    send_well(bus, since_s > 1.0 && since_s < 3.0 ? stuck : frame);
  });
  const Outcome outcome = service.end();
  CHECK(service.gives([](const nlohmann::json& line) {
    return line.contains("status") && line.at("status").at("state") == "tilt_resting";
  }));
  const nlohmann::json status = status_of(outcome);
  CHECK(status.at("state") == "ok");
  CHECK(status.at("tilt").at("times_rested") == 1);
  CHECK(times_said(outcome.err, "the tilt rests: the servo has stopped, or its encoder is stuck\n") == 1);
  CHECK(times_said(outcome.err, "the tilt moves again\n") == 1);
  int resting = 0, times = 0;
  can::CurbStatus told;
  for (const can::Frame& frame : socketcan::testing::receive_all(receiver)) {
    const bool before = told.resting;
    REQUIRE(can::read_curb_status(frame, told));
    CHECK(told.tilt == SourceState::ok);
    resting += told.resting;
    times += told.resting && !before;
  }
  CHECK(resting > 20);  // of the 40 lines of a second
  CHECK(resting < 80);
  CHECK(times == 1);
  CHECK_FALSE(told.resting);
}

TEST_CASE("daemon: a servo described in degrees is a state, told once", "[daemon]") {
  const TemporaryDirectory directory;
  const std::string degrees = directory.write("degrees.toml", "[tilt.signal]\nscale = 3.4332275390625e-4\n");
  Service service({"--can", "vcan0", "--scans", recording().path("scans.carmen"), "--robot", degrees});
  play(recording().path("can.log"), send_each);
  const Outcome outcome = service.end();
  const nlohmann::json status = status_of(outcome);
  CHECK(status.at("state") == "tilt_not_radians");
  CHECK(times_said(outcome.err, "expected radians, see scale of tilt.signal") == 1);
  CHECK(status_of(drive(send_each).outcome).at("tilt").at("beyond_a_turn") == 0);
}

TEST_CASE("daemon: angles that a servo samples on SYNC are those of replay, from the same frames", "[daemon]") {
  const TemporaryDirectory directory;
  std::string robot = read_file(shipped_robot("utm30lx"));
  robot.replace(robot.find("node = 1\n"), 9, "node = 1\nsync_id = 0x80\n");
  const Recording sampled("curb_above_below", directory.write("sampled.toml", robot), {"--duration", "3"});
  Service service({"--can", "vcan0", "--scans", sampled.path("scans.carmen"), "--robot", sampled.path("robot.toml")});
  play(sampled.path("can.log"), send_each);
  const nlohmann::json status = status_of(service.end());
  CHECK(status.at("tilt").at("readings") > 250);
  CHECK(status.at("tilt").at("without_sync") == 0);
  check_same(distinct_curbs(service.lines()), replayed_curbs(sampled.replay()));
}

TEST_CASE("daemon: sources that may be silent for longer, by the robot's description, are not told as silent sooner",
          "[daemon]") {
  const TemporaryDirectory directory;
  const std::string slow = directory.write("slow.toml", "[tilt]\nmax_gap_s = 2.0\n[pose]\nmax_extrapolation_s = 2.0\n");
  const std::string fifo = directory.path("fifo");
  REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
  Service service({"--can", "vcan0", "--scans", recording().path("scans.carmen"), "--robot", slow, "--poses", fifo});
  std::ofstream localisation(fifo);
  localisation << "1700000000 0 0 0 0 0 0 1" << std::endl;
  SocketCan servo;
  REQUIRE(servo.open("vcan0", {}) == socketcan::Status::ok);
  send_well(servo, first_frame_of(recording()));
  CHECK(service.says("the tilt servo reports\n"));
  CHECK(service.says("the localisation gives poses\n"));
  std::this_thread::sleep_for(1200ms);
  CHECK(times_said(service.said(), "silent") == 0);
  CHECK(service.says("the tilt servo is silent\n"));
  CHECK(service.says("the localisation is silent\n"));
  service.signal(SIGTERM);
  status_of(service.end());
}

TEST_CASE("daemon: repeated, swapped, late, cut and damaged frames are survived, reported once, and leave no trace",
          "[daemon]") {
  int number = 0, cut_short = 0;
  std::optional<can::Frame> held;
  const Drive disturbed = drive([&](SocketCan& bus, const can::Frame& frame, double since_s) {
    ++number;
    if (since_s > 1.5) return send_well(bus, frame);
    can::Frame changed = frame;
    switch (number % 12) {
      case 1:  // sent twice
        send_well(bus, frame);
        break;
      case 3:  // swapped with the next
        held = frame;
        return;
      case 4:
        send_well(bus, frame);
        changed = held.value_or(frame);
        break;
      case 6:  // late
        std::this_thread::sleep_for(25ms);
        break;
      case 8:  // a flipped bit in the angle's lowest byte
        changed.data[2] ^= 0x10;
        break;
      case 10:
        changed.length = 4;
        ++cut_short;
        break;
      default:
        break;
    }
    send_well(bus, changed);
  });
  const nlohmann::json status = status_of(disturbed.outcome);
  CHECK(status.at("tilt").at("malformed") == cut_short);
  CHECK(status.at("scans").at("lines") == 240);
  CHECK(times_said(disturbed.outcome.err, "damaged tilt frames") == 1);
  CHECK(times_said(disturbed.outcome.err, "tilt frames that the recording does not have") == 1);
  check_alike(last_curbs(disturbed.lines), end_of(recording()));
}

TEST_CASE("daemon: without the recording's CAN log beside the scan log the user is told of the guess", "[daemon]") {
  const TemporaryDirectory alone;
  const std::string scans = alone.write("lines.carmen", read_file(recording().path("scans.carmen")));
  Service service({"--can", "vcan0", "--scans", scans, "--robot", recording().path("robot.toml")});
  CHECK(times_said(service.said(), scans + ": no lines.candump or can.log beside it; expected one") == 1);
  service.signal(SIGTERM);
  CHECK(service.end().status == 0);
}

TEST_CASE("daemon: dropped scan lines are reported while servo and localisation are well", "[daemon]") {
  const TemporaryDirectory dir;
  std::string robot = read_file(recording().path("robot.toml"));
  const std::string allowed = "max_gap_s = 0.05\n";
  REQUIRE(robot.find(allowed) != robot.npos);
  robot.replace(robot.find(allowed), allowed.size(), "max_gap_s = 0.005\n");  // frames come every 10 ms
  const std::string late = dir.write("late.tum", "1700009999 0 0 0 0 0 0 1\n");
  Words words = daemon_words();
  words.back() = dir.write("gap.toml", robot);
  Service gap(words), drives(daemon_words({"--poses", late}));
  play(recording().path("can.log"), send_each);
  const Outcome of_gap = gap.end(), of_drive = drives.end();
  CHECK(status_of(of_gap).at("pipeline").at("lines") == 0);
  CHECK(times_said(of_gap.err, "scan lines with no tilt angle at their time, dropped; see max_gap_s (") == 1);
  CHECK(times_said(of_drive.err, "scan lines with no pose at their time, dropped (") == 1);
}

TEST_CASE("daemon: lines of a live scanner are joined with frames of a live bus on the host's clock", "[daemon]") {
  const std::string command =
      "'" CURBLINE_SCANNER "' scip2 --port 0 --scans '" + recording().path("scans.carmen") + "'";
  std::FILE* const scanner = ::popen(command.c_str(), "r");
  std::array<char, 80> address{};
  REQUIRE(std::fgets(address.data(), address.size(), scanner) != nullptr);
  const std::string scans = lines_of(address.data()).front();
  Service service({"--can", "vcan0", "--scans", scans, "--robot", recording().path("robot.toml")});
  CHECK(service.says("the scanner gives scan lines"));
  play(recording().path("can.log"), send_each);
  CHECK(service.says("no scan lines from the scanner"));  // its feed has ended
  service.signal(SIGINT);
  const Outcome outcome = service.end();
  ::pclose(scanner);
  const nlohmann::json status = status_of(outcome);
  CHECK(status.at("pipeline").at("lines") > 150);
  CHECK(status.at("scans").at("other_beams") == 0);
  CHECK(status.at("scans").at("damaged") == 0);
  CHECK(times_said(outcome.err, "stopped by SIGINT") == 1);
}

TEST_CASE("daemon: a scanner is waited for, an interface that is removed too, SIGTERM ends it cleanly", "[daemon]") {
  const socketcan::testing::Interface other("vcan8");
  Service service({"--can", "vcan8", "--scans", "scip2:127.0.0.1:7", "--robot", recording().path("robot.toml")});
  CHECK(service.says("no scan lines from the scanner scip2:127.0.0.1:7: Connection refused"));
  CHECK(service.says("no tilt frame since the start; expected id 0x181 of 11 bits on vcan8\n"));
  REQUIRE(vcan::remove_link("vcan8") == 0);
  CHECK(service.says("the CAN interface is gone"));
  REQUIRE(vcan::make_vcan("vcan8") == 0);
  CHECK(service.says("the CAN interface is up again"));
  service.signal(SIGTERM);
  const Outcome outcome = service.end();
  const nlohmann::json status = status_of(outcome);
  CHECK(status.at("state") == "tilt_missing");
  CHECK(status.at("scans").at("connected") == false);
  CHECK(times_said(outcome.err, "stopped by SIGTERM") == 1);
  CHECK(times_said(outcome.err, "no scan lines from the scanner") == 1);
  CHECK_FALSE(std::filesystem::exists(service.socket()));
}

}  // namespace
}  // namespace curbline::tools::testing
