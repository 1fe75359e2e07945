#include "program/tilt_frames.hpp"

#include <array>
#include <chrono>
#include <span>
#include <utility>

#include "formats/bad_input.hpp"
#include "socketcan/socketcan.hpp"
#include "streams/log_remarks.hpp"
#include "streams/recorded_times.hpp"

namespace curbline::tools {
namespace {

constexpr int first_silence_ms = 10'000, silence_ms = 2'000;

class LogFrames final : public TiltFrames {
 public:
  LogFrames(const std::string& path, const can::Signal& signal) : log_(path), signal_(signal) {}
  std::optional<can::Frame> next(std::int64_t) override {
    return first_ ? std::exchange(first_, std::nullopt) : read();
  }
  std::optional<std::int64_t> first_time_ns() override {
    first_ = read();
    return first_ ? std::optional(first_->time_ns) : std::nullopt;
  }
  bool ended() const override { return ended_; }
  void fail_silent() const override { throw BadInput(log_.path() + ": no more frames"); }
  std::string remarks() const override {
    Remarks remarks;
    say_lost_frames(remarks, log_);
    return remarks.text();
  }

 private:
  std::optional<can::Frame> read() {
    auto frame = log_.next();
    ended_ = !frame;
    if (frame) interface_.check(log_, signal_, *frame);
    return frame;
  }

  CanLogReader log_;
  can::Signal signal_;
  OneInterface interface_;
  std::optional<can::Frame> first_;  ///< read and not taken yet
  bool ended_ = false;
};

class LiveFrames final : public TiltFrames {
 public:
  LiveFrames(const std::string& interface_name, const can::Signal& signal, std::optional<std::uint16_t> sync_id,
             const std::optional<std::string>& scan_log)
      : name_("can:" + interface_name), signal_(signal) {
    const std::array filters{socketcan::filter_of(signal), socketcan::Filter{sync_id.value_or(0), CAN_SFF_MASK, false}};
    if (const auto status = bus_.open(interface_name.c_str(), std::span(filters).first(sync_id ? 2 : 1));
        status != socketcan::Status::ok) {
      throw BadInput(name_ + ": " + to_string(status) + "; expected a CAN interface, such as can0 or vcan0");
    }
    clock_ = scan_log ? LogClock::of_log(*scan_log, signal, sync_id) : LogClock::of_the_bus();
  }

  std::optional<can::Frame> next(std::int64_t line_ns) override {
    if (taken_ == held_) receive();
    if (taken_ == held_) return std::nullopt;
    can::Frame frame = frames_[taken_++];
    clock_.set_log_time(frame, line_ns);
    return frame;
  }

  bool ended() const override { return ended_; }

  void fail_silent() const override {
    const bool down = bus_.link() != socketcan::LinkState::up;
    throw BadInput(name_ + (down ? ": the interface is down or gone, and" : ":") + " no tilt frame for " +
                   std::to_string((clock_.offset_ns() ? silence_ms : first_silence_ms) / 1000) + " s; expected " +
                   frame_of(signal_) + " as the robot's description has it");
  }

  std::string remarks() const override {
    const auto& counters = bus_.counters();
    std::string text;
    const auto remark = [&](auto count, const std::string& what) {
      if (count > 0) text += (text.empty() ? name_ + ": " : ", ") + std::to_string(count) + " " + what;
    };
    remark(counters.frames_lost, "frames lost in this machine's receive buffer");
    remark(counters.times_down + counters.times_gone, "times the interface was down or gone");
    if (const RecordedTimes* recorded = clock_.recorded()) {
      remark(recorded->missed(), "tilt frames of " + recorded->path() + " did not come");
      remark(clock_.not_recorded(), "came that it does not have");
    }
    if (!clock_.guess().empty()) text += (text.empty() ? "" : "\n") + clock_.guess();
    return text;
  }

 private:
  /// Waits for frames; a bus that has fallen silent is polled once for each line, without waiting.
  void receive() {
    ended_ = clock_.offset_ns() && clock_.recorded() != nullptr && clock_.recorded()->ended();
    taken_ = held_ = 0;
    int left_ms = ended_ || silent_ ? 0 : clock_.offset_ns() ? silence_ms : first_silence_ms;
    do {
      const auto before = std::chrono::steady_clock::now();
      held_ = static_cast<std::size_t>(bus_.receive(frames_, left_ms));
      left_ms -= static_cast<int>((std::chrono::steady_clock::now() - before) / std::chrono::milliseconds(1));
    } while (held_ == 0 && left_ms > 0);
    silent_ = held_ == 0;
  }

  std::string name_;
  can::Signal signal_;
  socketcan::SocketCan bus_;
  LogClock clock_;
  std::array<can::Frame, socketcan::SocketCan::batch> frames_{};
  std::size_t taken_ = 0, held_ = 0;
  bool silent_ = false, ended_ = false;
};

}  // namespace

std::unique_ptr<TiltFrames> log_frames(const std::string& path, const can::Signal& signal) {
  return std::make_unique<LogFrames>(path, signal);
}

std::unique_ptr<TiltFrames> live_frames(const std::string& interface_name, const can::Signal& signal,
                                        std::optional<std::uint16_t> sync_id,
                                        const std::optional<std::string>& scan_log) {
  return std::make_unique<LiveFrames>(interface_name, signal, sync_id, scan_log);
}

std::optional<std::string> live_interface(const std::string& can) {
  if (!can.starts_with("can:")) return std::nullopt;
  return can.substr(4);
}

}  // namespace curbline::tools
