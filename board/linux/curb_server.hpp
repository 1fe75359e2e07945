// Sends lines of text to every client of a socket: the daemon's output of curbs.
//
// A client is never waited for. The kernel buffers up to send_buffer_bytes for each; a client that is further behind is
// dropped in the middle of a line, and may reconnect. What a client sends is not read. After open() nothing is
// allocated. To be used from one context.
#pragma once

#include <sys/types.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace curbline::daemon {

/// These only grow.
struct ServerCounters {
  std::uint32_t accepted = 0;
  std::uint32_t too_slow = 0;  ///< clients dropped
  std::uint32_t refused = 0;   ///< clients beyond max_clients
};

class CurbServer {
 public:
  static constexpr int max_clients = 16;
  static constexpr int send_buffer_bytes = 256 << 10;

  CurbServer() { clients_.fill(-1); }
  ~CurbServer();
  CurbServer(const CurbServer&) = delete;
  CurbServer& operator=(const CurbServer&) = delete;

  /// Listens at unix:PATH or tcp:HOST:PORT (port 0: any), of a name with several addresses at the first that can be
  /// listened at: localhost is ::1 too where IPv6 is off. A socket file without a listener is replaced. Throws
  /// BadInput.
  void open(const std::string& address);

  /// The address, with the actual port.
  const std::string& address() const { return address_; }
  int descriptor() const { return listener_; }  ///< for poll(2), POLLIN; then call accept_client()

  /// The next waiting client, for send_to(); -1 if there is none.
  int accept_client();

  void send_to(int client, std::string_view line);
  void send(std::string_view line);

  int clients() const { return connected_; }
  const ServerCounters& counters() const { return counters_; }

 private:
  void listen_unix(const std::string& path);
  void listen_tcp(const std::string& host, std::uint16_t port);
  /// Drops the clients that are gone. If none is for certain, those that will send no more: a TCP client that has
  /// closed its connection looks like one until something is sent to it.
  void drop_hung_up();
  void drop(int client);

  std::string address_, path_;  ///< path_: the socket file, to be removed
  ino_t file_number_ = 0;       ///< its own: another may have come in its place
  int listener_ = -1;
  int connected_ = 0;
  std::array<int, max_clients> clients_{};  ///< descriptors, -1 for a free place
  ServerCounters counters_{};
};

}  // namespace curbline::daemon
