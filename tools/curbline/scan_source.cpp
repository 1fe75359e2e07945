#include "curbline/scan_source.hpp"

#include <signal.h>

#include <atomic>
#include <charconv>
#include <cstring>
#include <iostream>

#include "cola/session.hpp"
#include "formats/bad_input.hpp"
#include "lms200/session.hpp"
#include "scanner/live_scanner.hpp"
#include "scip2/session.hpp"

namespace curbline::tools {
namespace {

using port::ByteStream, port::Milliseconds, scanner::LiveScanner;

constexpr Milliseconds tcp_silence{5'000}, serial_silence{10'000};  // an LMS200 is first looked for at four speeds
constexpr std::string_view scip2_scheme = "scip2:", cola_scheme = "cola:", lms200_scheme = "lms200:";

std::atomic<bool> interrupted = false;

void interrupt(int) {
  interrupted = true;
}

/// Ctrl-C ends the scan while this lives; a second one is the system's.
class InterruptWatch {
 public:
  InterruptWatch() {
    interrupted = false;
    struct sigaction action {};
    action.sa_handler = interrupt;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    ::sigaction(SIGINT, &action, &before_);
  }
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;
  ~InterruptWatch() { ::sigaction(SIGINT, &before_, nullptr); }

 private:
  struct sigaction before_ {};
};

class LogSource final : public ScanSource {
 public:
  LogSource(const std::string& path, const LaserSettings& laser) : reader_(path), laser_(laser) {}

  std::optional<CarmenLine> next() override {
    auto line = reader_.next();
    if (line) check_geometry(*line, laser_, reader_.path(), reader_.line());
    return line;
  }

 private:
  CarmenReader reader_;
  LaserSettings laser_;
};

class LiveSource final : public ScanSource {
 public:
  template <typename Protocol>
  LiveSource(const std::string& name, std::shared_ptr<Protocol> session, ByteStream stream, Milliseconds silence,
             const LaserSettings& laser, std::optional<std::int64_t> log_time_ns)
      : name_(name),
        owner_(session),
        session_(*session),
        scanner_(session_, std::move(stream), {.reconnect = false, .silence = silence}),
        silence_(silence),
        laser_(laser),
        log_time_ns_(log_time_ns) {
    if (const int failed = scanner_.open(); failed != 0) {
      throw BadInput(name + ": " + std::strerror(failed) + "; expected a scanner there");
    }
  }

  std::optional<CarmenLine> next() override {
    while (!interrupted) {
      switch (scanner_.read(Milliseconds{100})) {
        case LiveScanner::Event::line:
          return take_line();
        case LiveScanner::Event::nothing:
          break;
        case LiveScanner::Event::lost:
          end();
          return std::nullopt;
      }
    }
    return std::nullopt;
  }

 private:
  CarmenLine take_line() {
    const scanner::Line& line = session_.line();
    CarmenLine scan;
    scan.time_ns = line.host_ns;
    if (log_time_ns_) {
      log_time_ns_ = session_.log_time_ns(*log_time_ns_);
      scan.time_ns = *log_time_ns_;
    }
    scan.start_angle_rad = static_cast<double>(line.first_bearing_rad);
    scan.angular_resolution_rad = static_cast<double>(line.bearing_step_rad);
    scan.field_of_view_rad = scan.angular_resolution_rad * static_cast<double>(line.ranges_m.size() - 1);
    scan.maximum_range_m = static_cast<double>(laser_.max_range_m);
    scan.ranges_m.assign(line.ranges_m.begin(), line.ranges_m.end());
    check_geometry(scan, laser_, name_, ++lines_);
    return scan;
  }

  /// A connection that ends after its first line is an end like that of a log.
  void end() const {
    const bool silent = scanner_.last_error() == ETIMEDOUT;
    std::string what = silent ? "no scan line for " + std::to_string(silence_.count() / 1000) + " s"
                              : "closed the connection before its first scan line";
    if (!session_.problem().empty()) what += ", " + std::string(session_.problem());
    if (lines_ == 0) throw BadInput(name_ + ": " + what + "; expected scan lines");
    if (silent) std::cerr << name_ << ": " << what << "; taken as its end\n";
  }

  std::string name_;
  std::shared_ptr<void> owner_;
  scanner::Session& session_;
  LiveScanner scanner_;
  Milliseconds silence_;
  LaserSettings laser_;
  std::optional<std::int64_t> log_time_ns_;
  long lines_ = 0;
  InterruptWatch watch_;
};

struct Endpoint {
  std::string host;
  std::uint16_t port;
};

/// HOST, HOST:PORT, [IPV6] or [IPV6]:PORT behind the scheme.
Endpoint parse_endpoint(const std::string& name, std::size_t scheme_size, std::uint16_t default_port) {
  std::string host = name.substr(scheme_size), port;
  const std::size_t bracket = host.find(']');
  if (const std::size_t colon = host.rfind(':');
      colon != std::string::npos && (bracket == std::string::npos || colon > bracket)) {
    port = host.substr(colon + 1);
    host.resize(colon);
    const auto [end, failed] = std::from_chars(port.data(), port.data() + port.size(), default_port);
    if (failed != std::errc{} || end != port.data() + port.size() || default_port == 0) {
      throw BadInput(name + ": port is \"" + port + "\"; expected a number from 1 to 65535");
    }
  }
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  if (host.empty())
    throw BadInput(name + ": no host; expected " + name.substr(0, scheme_size) + "HOST or " +
                   name.substr(0, scheme_size) + "HOST:PORT");
  return {host, default_port};
}

ByteStream tcp_stream(const std::string& name, const Endpoint& endpoint) {
  std::string error;
  auto stream = ByteStream::tcp(endpoint.host, endpoint.port, error);
  if (!stream) throw BadInput(name + ": " + error + "; expected the name or address of a scanner");
  return std::move(*stream);
}

}  // namespace

bool is_scanner(const std::string& scans) {
  return scans.starts_with(scip2_scheme) || scans.starts_with(cola_scheme) || scans.starts_with(lms200_scheme);
}

std::unique_ptr<ScanSource> open_scan_source(const std::string& scans, const LaserSettings& laser,
                                             std::optional<std::int64_t> log_time_ns) {
  if (scans.starts_with(scip2_scheme)) {
    auto stream = tcp_stream(scans, parse_endpoint(scans, scip2_scheme.size(), scip2::tcp_port));
    return std::make_unique<LiveSource>(scans, std::make_shared<scip2::Session>(), std::move(stream), tcp_silence,
                                        laser, log_time_ns);
  }
  if (scans.starts_with(cola_scheme)) {
    auto stream = tcp_stream(scans, parse_endpoint(scans, cola_scheme.size(), cola::tcp_port));
    return std::make_unique<LiveSource>(scans, std::make_shared<cola::Session>(), std::move(stream), tcp_silence, laser,
                                        log_time_ns);
  }
  if (scans.starts_with(lms200_scheme)) {
    if (log_time_ns)
      throw BadInput(scans +
                     ": its telegrams bear no time that a log could be joined by; expected --can can:IFACE, or a robot "
                     "without CAN and poses");
    auto session = std::make_shared<lms200::Session>(static_cast<std::size_t>(laser.beams));
    return std::make_unique<LiveSource>(scans, std::move(session),
                                        ByteStream::serial(scans.substr(lms200_scheme.size())), serial_silence, laser,
                                        log_time_ns);
  }
  return std::make_unique<LogSource>(scans, laser);
}

}  // namespace curbline::tools
