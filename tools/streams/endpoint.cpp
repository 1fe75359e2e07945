#include "streams/endpoint.hpp"

#include "formats/bad_input.hpp"
#include "formats/parse_number.hpp"

namespace curbline::tools {
namespace {

std::uint16_t parse_port(const std::string& name, const std::string& text, std::uint16_t lowest) {
  const auto port = parse_number<std::uint16_t>(text);
  if (!port || *port < lowest) {
    throw BadInput(name + ": port is \"" + text + "\"; expected a number from " + std::to_string(lowest) + " to 65535");
  }
  return *port;
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
