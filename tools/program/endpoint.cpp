#include "program/endpoint.hpp"

#include <charconv>

#include "formats/bad_input.hpp"

namespace curbline::tools {
namespace {

std::uint16_t parse_port(const std::string& name, const std::string& text, std::uint16_t lowest) {
  std::uint16_t port = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (failed != std::errc{} || end != text.data() + text.size() || port < lowest) {
    throw BadInput(name + ": port is \"" + text + "\"; expected a number from " + std::to_string(lowest) + " to 65535");
  }
  return port;
}

}  // namespace

Endpoint parse_endpoint(const std::string& name, std::size_t scheme_size, std::uint16_t lowest_port) {
  Endpoint endpoint{name.substr(scheme_size), {}};
  std::string& host = endpoint.host;
  const std::size_t bracket = host.find(']');
  if (const std::size_t colon = host.rfind(':');
      colon != std::string::npos && (bracket == std::string::npos || colon > bracket)) {
    endpoint.port = parse_port(name, host.substr(colon + 1), lowest_port);
    host.resize(colon);
  }
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  return endpoint;
}

}  // namespace curbline::tools
