// Host and port of a name such as scip2:HOST:PORT, for --scans and for the daemon's --curbs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace curbline::tools {

struct Endpoint {
  std::string host;  ///< without the brackets of an IPv6 address
  std::optional<std::uint16_t> port;
};

/// HOST, HOST:PORT, [IPV6] or [IPV6]:PORT after the scheme. Throws BadInput for an invalid port.
Endpoint parse_endpoint(const std::string& name, std::size_t scheme_size, std::uint16_t lowest_port = 1);

}  // namespace curbline::tools
