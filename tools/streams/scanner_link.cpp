#include "streams/scanner_link.hpp"

#include "cola/session.hpp"
#include "formats/bad_input.hpp"
#include "lms200/session.hpp"
#include "scip2/session.hpp"
#include "streams/endpoint.hpp"

namespace curbline::tools {
namespace {

using port::ByteStream, port::Milliseconds;

constexpr Milliseconds tcp_silence{5'000}, serial_silence{10'000};  // for an LMS200, four speeds are tried first
constexpr std::string_view scip2_scheme = "scip2:", cola_scheme = "cola:", lms200_scheme = "lms200:";

ByteStream tcp_stream(const std::string& name, std::string_view scheme, std::uint16_t default_port) {
  const Endpoint endpoint = parse_endpoint(name, scheme.size());
  if (endpoint.host.empty()) {
    const std::string expected = std::string(scheme) + "HOST";
    throw BadInput(name + ": no host; expected " + expected + " or " + expected + ":PORT");
  }
  std::string error;
  auto stream = ByteStream::tcp(endpoint.host, endpoint.port.value_or(default_port), error);
  if (!stream) throw BadInput(name + ": " + error + "; expected the name or address of a scanner");
  return std::move(*stream);
}

}  // namespace

bool is_scanner(const std::string& scans) {
  return scans.starts_with(scip2_scheme) || scans.starts_with(cola_scheme) || scans.starts_with(lms200_scheme);
}

ScannerLink scanner_link(const std::string& scans, const LaserSettings& laser) {
  if (scans.starts_with(scip2_scheme)) {
    auto stream = tcp_stream(scans, scip2_scheme, scip2::tcp_port);
    return {std::make_shared<scip2::Session>(), std::move(stream), tcp_silence, true};
  }
  if (scans.starts_with(cola_scheme)) {
    auto stream = tcp_stream(scans, cola_scheme, cola::tcp_port);
    return {std::make_shared<cola::Session>(), std::move(stream), tcp_silence, true};
  }
  const std::string device = scans.substr(lms200_scheme.size());
  if (device.empty()) throw BadInput(scans + ": no device; expected lms200:DEVICE");
  auto session = std::make_shared<lms200::Session>(static_cast<std::size_t>(laser.beams));
  return {std::move(session), ByteStream::serial(device), serial_silence, false};
}

}  // namespace curbline::tools
