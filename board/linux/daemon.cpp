#include "daemon.hpp"

#include <poll.h>
#include <pthread.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <utility>

#include "curbline/can/curb_frames.hpp"
#include "formats/bad_input.hpp"
#include "formats/can_log.hpp"
#include "heap_trap.hpp"

namespace curbline::daemon {
namespace {

using tools::BadInput;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t status_period_ns = 1000 * ms, look_period_ns = 50 * ms;
/// How long a busy machine may delay a frame. A waiting line costs nothing, and without tilt it is useless.
constexpr float longest_wait_s = 1.0f;
/// Longer than any delay of a busy machine: a source that is silent for longer is reported to the user.
constexpr float least_stale_s = 0.5f;
/// Half width of the way ahead, for a robot that drives on pavements and through doors.
constexpr float half_way_m = 0.4f;
/// Two lines lost in a row, as by damage, are no silence.
float silent_after_s(const tools::Robot& robot) {
  return std::max(3.0f / static_cast<float>(robot.scan_rate_hz), least_stale_s);
}
/// There and back.
float longest_sweep_s(const tools::Robot& robot) {
  return std::max(static_cast<float>(robot.sweep.period_s), least_stale_s);
}
constexpr int most_batches = 16;  ///< of frames, before other work gets its turn

/// SIGHUP says that the terminal has closed; nohup has it ignored, but a blocked signal would come here all the same.
int signal_descriptor() {
  sigset_t stop;
  sigemptyset(&stop);
  sigaddset(&stop, SIGTERM);
  sigaddset(&stop, SIGINT);
  struct sigaction hang_up {};
  if (::sigaction(SIGHUP, nullptr, &hang_up) == 0 && hang_up.sa_handler != SIG_IGN) sigaddset(&stop, SIGHUP);
  ::pthread_sigmask(SIG_BLOCK, &stop, nullptr);
  return ::signalfd(-1, &stop, SFD_CLOEXEC | SFD_NONBLOCK);
}

}  // namespace

Daemon::Daemon(const tools::Robot& robot, const Options& options)
    : laser_(robot.laser),
      tilt_settings_(robot.tilt),
      scan_line_s_(1.0 / robot.scan_rate_hz),
      pipeline_(tools::make_live_pipeline(robot)) {
  inbox_.init(robot, longest_wait_s);
  open_scans(robot, options);
  open_bus(robot, options);
  tilt_decoder_.init(robot.tilt_signal, robot.tilt_sync_id);
  tilt_watch_.init(std::max(robot.tilt.max_gap_s, least_stale_s), robot.tilt.fixed);
  nod_watch_.init(longest_sweep_s(robot), robot.tilt.fixed);
  radians_watch_.init(longest_sweep_s(robot));
  sight_.init(robot.tilt.fixed ? least_stale_s : longest_sweep_s(robot));
  poses_.open(robot, options.poses, log_.has_value(), std::max(robot.pose.max_extrapolation_s, least_stale_s));
  signals_ = signal_descriptor();  // until here, a signal ends the process: reading a log may take for ever
  server_.open(options.curbs);
}

Daemon::~Daemon() {
  ::close(signals_);
}

void Daemon::open_scans(const tools::Robot& robot, const Options& options) {
  if (tools::is_scanner(options.scans)) {
    scanner_ = std::make_unique<ScannerThread>(options.scans, tools::scanner_link(options.scans, robot.laser),
                                               robot.laser, inbox_, silent_after_s(robot));
    return;
  }
  log_.emplace(options.scans, robot.laser);
  if (robot.tilt.fixed) return;
  clock_ = tools::LogClock::of_log(options.scans, robot.tilt_signal, robot.tilt_sync_id);
  if (tools::RecordedTimes* recorded = clock_.recorded()) recorded->read_all();
}

void Daemon::open_bus(const tools::Robot& robot, const Options& options) {
  has_bus_ = !options.can.empty();
  can_out_ = options.can_out;
  if (!has_bus_) {
    if (robot.tilt.fixed) return;
    throw BadInput(robot.file + ": the laser nods; expected --can IFACE, or tilt.fixed = true");
  }
  if (can_out_ && !robot.tilt.fixed && can::shares_ids(robot.tilt_signal, robot.tilt_sync_id)) {
    throw BadInput(robot.file +
                   ": its tilt frames, or SYNC, have an id from 0x6A0 to 0x6BF, as those of --can-out; "
                   "expected another, for an ODrive another node than 53");
  }
  const std::array filters{socketcan::filter_of(robot.tilt_signal),
                           socketcan::Filter{robot.tilt_sync_id.value_or(0), CAN_SFF_MASK, false}};
  const std::size_t wanted = robot.tilt.fixed ? 0 : robot.tilt_sync_id ? 2 : 1;
  const auto status = bus_.open(options.can.c_str(), std::span(filters).first(wanted));
  if (status != socketcan::Status::ok) {
    throw BadInput(options.can + ": " + to_string(status) + "; expected a CAN interface, such as can0 or vcan0");
  }
  wanted_tilt_ = tools::frame_of(robot.tilt_signal) + " on " + options.can +
                 (log_ ? ", with which the log of scan lines begins" : "");
}

void Daemon::run() {
  const scanner::Now now = scanner::host_now();
  started_ns_ = now.steady_ns;
  if (log_ && tilt_settings_.fixed) fixed_offset_ns_ = log_->front_ns() - now.host_ns;
  if (scanner_) scanner_->start();
  if (log_ && !log_->remarks().empty()) say(log_->remarks());
  if (!clock_.guess().empty()) say(clock_.guess());
  if (has_bus_ && tilt_settings_.fixed && !can_out_) say("the tilt is fixed: nothing is read from --can");
  say("ready, curbs at ", server_.address());
  service_.notify("READY=1");
  heap_calls_before_ = heap_calls();
  while (wait()) {
    take_clients();
    if (has_bus_) take_frames();
    poses_.take(*pipeline_);
    if (log_) take_log();
    take_lines();
    look_around();
    if (log_ && log_->ended() && inbox_.empty()) {
      say("the log of scan lines has ended");
      break;
    }
  }
  service_.notify("STOPPING=1");
  give_status();
}

/// Waits for work. False on a signal to stop.
bool Daemon::wait() {
  const bool listens = has_bus_ && bus_.link() == socketcan::LinkState::up;  // if down, its descriptor is always ready
  std::array<pollfd, 5> ready{{{signals_, POLLIN, 0},
                               {server_.descriptor(), POLLIN, 0},
                               {inbox_.descriptor(), POLLIN, 0},
                               {listens ? bus_.descriptor() : -1, POLLIN, 0},
                               {poses_.descriptor(), POLLIN, 0}}};
  ::poll(ready.data(), ready.size(), time_to_wait_ms());
  if ((ready[2].revents & POLLIN) != 0) inbox_.quiet();
  if ((ready[0].revents & POLLIN) == 0) return true;
  signalfd_siginfo signal{};
  if (::read(signals_, &signal, sizeof signal) != sizeof signal) return true;
  say("stopped by SIG", std::string_view(::sigabbrev_np(static_cast<int>(signal.ssi_signo))));
  return false;
}

int Daemon::time_to_wait_ms() const {
  const scanner::Now now = scanner::host_now();
  std::int64_t until_ns = next_look_ns_ - now.steady_ns;
  if (const auto offset_ns = log_offset_ns(); log_ && offset_ns && !log_->ended()) {
    until_ns = std::min(until_ns, log_->due_ns() - *offset_ns - now.host_ns);
  }
  return static_cast<int>(std::clamp<std::int64_t>((until_ns + ms - 1) / ms, 0, look_period_ns / ms));
}

void Daemon::take_clients() {
  for (int client = 0; (client = server_.accept_client()) >= 0;) {
    server_.send_to(client, status());
    if (!curbs_given_.empty()) server_.send_to(client, curbs_given_);
  }
}

void Daemon::take_frames() {
  for (int batch = 0; batch < most_batches; ++batch) {
    const int count = bus_.receive(frames_, 0);
    for (int i = 0; i < count; ++i) take_frame(frames_[static_cast<std::size_t>(i)]);
    if (count < static_cast<int>(frames_.size())) return;
  }
}

void Daemon::take_frame(can::Frame frame) {
  const std::int64_t received_ns = frame.time_ns;
  clock_.set_log_time(frame, log_ && !log_->ended() ? log_->front_ns() : frame.time_ns);
  const auto reading = tilt_decoder_.take(frame);
  if (!reading || !pipeline_->add_tilt(*reading)) return;
  newest_tilt_ns_ = reading->time_ns;
  if (const SourceEvent event = nod_watch_.update(*reading); event != SourceEvent::none) nod_event_ = event;
  radians_watch_.update(*reading);
  newest_frame_ns_ = received_ns;
  newest_arrival_ns_ = scanner::steady_now_ns();
  by_frame_ = true;
  take_lines();
  by_frame_ = false;
}

/// Log time minus host time; empty until it is known.
std::optional<std::int64_t> Daemon::log_offset_ns() const {
  return fixed_offset_ns_ ? fixed_offset_ns_ : clock_.offset_ns();
}

void Daemon::take_log() {
  const auto offset_ns = log_offset_ns();
  if (!offset_ns) return;
  const scanner::Now now = scanner::host_now();
  while (!log_->ended() && log_->due_ns() - *offset_ns <= now.host_ns) {
    inbox_.push(log_->take(), now.steady_ns);
    take_lines();
  }
}

/// Processes the lines whose tilt and pose the pipeline has, and those that have waited too long.
void Daemon::take_lines() {
  for (;;) {
    bool covered = false;
    const float offset_s = pipeline_->tilt_latency().latest_offset_s();
    const auto line = inbox_.pop({newest_tilt_ns_, poses_.newest_ns()}, scanner::steady_now_ns(), offset_s, covered);
    if (!line) return;
    take_line(*line);
    if (covered && by_frame_) latency_.add(scanner::host_now().host_ns - newest_frame_ns_);
  }
}

void Daemon::take_line(const ScanLine& line) {
  poses_.take_until(line.time_ns + laser_.duration_ns(line.ranges_m.size()), *pipeline_);
  const std::int64_t before_ns = scanner::steady_now_ns();
  const Status status = pipeline_->take(line);
  if (status == Status::ok) work_.add(scanner::steady_now_ns() - before_ns);
  note_dropped(status);
  const bool sees = sight_.update(pipeline_->counters(), line.time_ns);
  if (sight_.event() != SourceEvent::none) sight_event_ = sight_.event();
  give_curbs(line.time_ns);
  if (can_out_) send_curbs(sees);
}

/// A silent servo or localisation is told as such.
void Daemon::note_dropped(Status status) {
  const SourceWatch* const poses = poses_.report().watch;
  if (status == Status::no_tilt && tilt_watch_.state() == SourceState::ok) ++lines_without_tilt_;
  if (status == Status::no_pose && poses != nullptr && poses->state() == SourceState::ok) ++lines_without_pose_;
}

/// Sends the curbs to the clients if they have changed.
void Daemon::give_curbs(std::int64_t line_ns) {
  auto& buffer = curbs_given_.data() == curb_texts_[0].data() ? curb_texts_[1] : curb_texts_[0];
  std::uint32_t left_out = 0;
  const std::string_view text = curbs_line(line_ns, pipeline_->curbs(), buffer, left_out);
  const auto curbs_of = [](std::string_view line) { return line.substr(std::min(line.find('['), line.size())); };
  if (curbs_of(text) == curbs_of(curbs_given_)) return;
  curbs_left_out_ += left_out;
  curbs_given_ = text;
  server_.send(text);
}

/// Sends, after a scan line, the curb ahead if the laser sees, then the status, whose counter shows a receiver whether
/// it does.
void Daemon::send_curbs(bool sees) {
  if (sees) {
    const auto ahead = can::curb_ahead_frame(nearest_ahead(pipeline_->curbs(), poses_.newest(), half_way_m));
    if (bus_.send(ahead) == socketcan::Status::ok) ++curbs_sent_;
  }
  const auto curbs = static_cast<std::uint32_t>(pipeline_->curbs().size());
  const bool rests = nod_watch_.watch().state() == SourceState::stale;
  bus_.send(can::curb_status_frame({curbs_sent_, tilt_watch_.state(), curbs, rests}));
}

/// Reports events to the user; runs several times a second.
void Daemon::look_around() {
  const std::int64_t now_ns = scanner::steady_now_ns();
  if (now_ns < next_look_ns_) return;
  next_look_ns_ = now_ns + look_period_ns;
  const SourceEvent tilt = tilt_watch_.update(newest_arrival_ns_, now_ns);
  const SourceEvent poses = poses_.update(now_ns);
  const Report status = make_report();
  troubles_.tell(
      status,
      {tilt, std::exchange(nod_event_, SourceEvent::none), poses, std::exchange(sight_event_, SourceEvent::none)},
      now_ns);
  const std::string_view state = state_of(status);
  if (state == told_state_ && now_ns < next_status_ns_) return;
  if (state != told_state_) {
    JournalLine text;
    text << "STATUS=" << state;
    service_.notify(text.text());
  }
  told_state_ = state;
  next_status_ns_ = now_ns + status_period_ns;
  service_.notify("WATCHDOG=1");
  give_status();
}

void Daemon::give_status() {
  server_.send(status());
}

std::string_view Daemon::status() {
  return status_line(make_report(), status_text_);
}

Report Daemon::make_report() {
  const scanner::Now now = scanner::host_now();
  Report s;
  s.time_ns = now.host_ns;
  s.uptime_s = 1e-9 * static_cast<double>(now.steady_ns - started_ns_);
  s.scan_line_s = scan_line_s_;
  if (!tilt_settings_.fixed) {
    tilt_counters_ = tilt_decoder_.counters();
    s.tilt = &tilt_watch_;
    s.nod = &nod_watch_.watch();
    s.wanted_tilt = wanted_tilt_;
    s.tilt_frames = &tilt_counters_;
    s.tilt_latency = &pipeline_->tilt_latency();
    s.latency = &latency_;
    s.angles_in_doubt = radians_watch_.in_doubt();
    s.angles_beyond = radians_watch_.beyond();
  }
  s.poses = poses_.report();
  s.sight = &sight_.watch();
  if (has_bus_) s.bus = {bus_.link(), bus_.bus(), bus_.counters()};
  if (scanner_) {
    scanner_state_ = scanner_->state();
    s.scanner = &scanner_state_;
  }
  s.not_recorded = clock_.recorded() == nullptr ? 0 : static_cast<std::uint64_t>(clock_.not_recorded());
  s.lines = inbox_.counters();
  s.lines_without_tilt = lines_without_tilt_;
  s.lines_without_pose = lines_without_pose_;
  s.pipeline = pipeline_->counters();
  s.curbs = pipeline_->curbs().size();
  s.curbs_left_out = curbs_left_out_;
  s.clients = server_.clients();
  s.server = server_.counters();
  s.work = &work_;
  s.heap_calls_before = heap_calls_before_;
  s.heap_calls_since = heap_calls() - heap_calls_before_;
  return s;
}

}  // namespace curbline::daemon
