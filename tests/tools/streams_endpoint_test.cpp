// Host and port in the names of scanners and of the daemon's own address.
#include "streams/endpoint.hpp"

#include "formats_support.hpp"

namespace curbline::tools::testing {
namespace {

TEST_CASE("endpoint: a port follows a name, an address, or an IPv6 address in brackets") {
  struct {
    const char* name;
    const char* host;
    std::optional<std::uint16_t> port;
  } const cases[] = {
      {"scip2:laser", "laser", {}},        {"scip2:laser:10940", "laser", 10940},
      {"scip2:10.0.0.2:1", "10.0.0.2", 1}, {"scip2:[::1]", "::1", {}},
      {"scip2:[::1]:65535", "::1", 65535}, {"scip2:[fe80::2%eth0]:7", "fe80::2%eth0", 7},
      {"scip2::2112", "", 2112},
  };
  for (const auto& [name, host, port] : cases) {
    INFO(name);
    const Endpoint endpoint = parse_endpoint(name, 6);
    CHECK(endpoint.host == host);
    CHECK(endpoint.port == port);
  }
}

TEST_CASE("endpoint: a port that is none is refused, also behind brackets") {
  for (const std::string name : {"tcp:laser:", "tcp:laser:0", "tcp:laser:65536", "tcp:[::1]:x", "tcp:[::1]:-1"}) {
    const std::string port = name.substr(name.rfind(':') + 1);
    CHECK(error_of([&] { parse_endpoint(name, 4); }) ==
          name + ": port is \"" + port + "\"; expected a number from 1 to 65535");
  }
  CHECK(parse_endpoint("tcp:[::1]:0", 4, 0).port == 0);
}

}  // namespace
}  // namespace curbline::tools::testing
