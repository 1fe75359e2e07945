// Reports the state of the service to systemd (Type=notify): a datagram to the socket named in the environment. Without
// such a socket it does nothing. Source: sd_notify(3).
#pragma once

#include <sys/un.h>

#include <string_view>

namespace curbline::daemon {

class ServiceManager {
 public:
  ServiceManager();
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  /// "READY=1", "WATCHDOG=1", "STOPPING=1", "STATUS=...". Does not wait or allocate.
  void notify(std::string_view state) const;

 private:
  int socket_ = -1;
  sockaddr_un address_{};
  unsigned address_size_ = 0;
};

}  // namespace curbline::daemon
