#include "curbline/scanner_link.hpp"

#include <charconv>

#include "cola/session.hpp"
#include "formats/bad_input.hpp"
#include "lms200/session.hpp"
#include "scip2/session.hpp"

namespace curbline::tools {
namespace {

using port::ByteStream, port::Milliseconds;

constexpr Milliseconds tcp_silence{5'000}, serial_silence{10'000};  // an LMS200 is first looked for at four speeds
constexpr std::string_view scip2_scheme = "scip2:", cola_scheme = "cola:", lms200_scheme = "lms200:";

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

ScannerLink scanner_link(const std::string& scans, const LaserSettings& laser) {
  if (scans.starts_with(scip2_scheme)) {
    auto stream = tcp_stream(scans, parse_endpoint(scans, scip2_scheme.size(), scip2::tcp_port));
    return {std::make_shared<scip2::Session>(), std::move(stream), tcp_silence, true};
  }
  if (scans.starts_with(cola_scheme)) {
    auto stream = tcp_stream(scans, parse_endpoint(scans, cola_scheme.size(), cola::tcp_port));
    return {std::make_shared<cola::Session>(), std::move(stream), tcp_silence, true};
  }
  auto session = std::make_shared<lms200::Session>(static_cast<std::size_t>(laser.beams));
  return {std::move(session), ByteStream::serial(scans.substr(lms200_scheme.size())), serial_silence, false};
}

}  // namespace curbline::tools
