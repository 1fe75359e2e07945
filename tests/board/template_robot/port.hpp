// Replaces port/_template and the template's robot.hpp. The records of a drive, in order, stand for the bus and the
// scanner, and define the time. What the robot sends is written to a file, as records. With CURBLINE_FULL_BUS set, the
// bus takes only two of three CurbAhead.
#pragma once

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <span>

#include "curbline/can/curb_frames.hpp"
#include "curbline/limits.hpp"
#include "curbline/pose.hpp"
#include "curbline/scan_line.hpp"
#include "drive_log/drive_log.hpp"

inline constexpr curbline::Limits limits{};

class Port {
 public:
  using Kind = curbline::drive_log::RecordKind;

  explicit Port(const char* drive = std::getenv("CURBLINE_DRIVE"), const char* sent = std::getenv("CURBLINE_SENT"))
      : drive_(std::fopen(drive, "rb")), sent_(std::fopen(sent, "wb")) {
    if (drive_ == nullptr || sent_ == nullptr) stop("CURBLINE_DRIVE or CURBLINE_SENT is no file");
    next();
    read(setup_);
  }
  const curbline::drive_log::Setup& setup() const { return setup_; }

  bool open(const curbline::can::Signal&) { return true; }
  std::int64_t now_ns() const { return now_ns_; }

  int receive(std::span<curbline::can::Frame> out) {
    int n = 0;
    for (curbline::can::Frame& frame : out) {
      if (header_.kind != Kind::can_frame) break;
      read(frame);
      now_ns_ = frame.time_ns;
      ++n;
    }
    return n;
  }

  std::optional<curbline::ScanLine> scan_line() {
    if (header_.kind != Kind::scan_line) return std::nullopt;
    curbline::drive_log::ScanLineHead head;
    const std::span<float> ranges_m = std::span(ranges_m_).first((header_.bytes - sizeof head) / sizeof(float));
    if (std::fread(&head, sizeof head, 1, drive_) != 1) stop("the drive is cut");
    now_ns_ = std::max(now_ns_, head.time_ns);
    if (std::fread(ranges_m.data(), sizeof(float), ranges_m.size(), drive_) != ranges_m.size())
      stop("the drive is cut");
    next();
    return curbline::ScanLine{head.time_ns, ranges_m};
  }

  std::optional<curbline::Pose> pose() {
    if (header_.kind != Kind::pose) return std::nullopt;
    curbline::Pose pose;
    read(pose);
    return pose;
  }

  bool send(const curbline::can::Frame& frame) {
    if (full_ && frame.id == curbline::can::curb_ahead_id && ++ahead_ % 3 == 0) return false;
    const curbline::drive_log::RecordHeader header{Kind::can_frame, sizeof frame};
    return std::fwrite(&header, sizeof header, 1, sent_) == 1 && std::fwrite(&frame, sizeof frame, 1, sent_) == 1;
  }

  void rest() {
    if (header_.kind == Kind{}) std::exit(std::fclose(sent_) == 0 ? 0 : 1);
  }

  [[noreturn]] void stop(const char* why) {
    std::fprintf(stderr, "%s\n", why);
    std::exit(1);
  }

 private:
  void next() {
    if (std::fread(&header_, sizeof header_, 1, drive_) != 1) header_ = {};
  }
  template <typename T>
  void read(T& value) {
    if (header_.bytes != sizeof value || std::fread(&value, sizeof value, 1, drive_) != 1)
      stop("the drive is of another build");
    next();
  }

  std::FILE *drive_, *sent_;
  bool full_ = std::getenv("CURBLINE_FULL_BUS") != nullptr;
  int ahead_ = 0;  ///< CurbAhead to send so far
  curbline::drive_log::RecordHeader header_{};
  curbline::drive_log::Setup setup_{};
  std::int64_t now_ns_ = 0;
  std::array<float, limits.beams> ranges_m_{};
};
