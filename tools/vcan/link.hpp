// Creates and removes network interfaces, and takes them up and down, through netlink: the functions of `ip link`
// without depending on it. For the program behind tools/with-vcan and for tests. Needs CAP_NET_ADMIN in the network
// namespace. Each call returns 0 or a negative errno. Source: rtnetlink(7).
#pragma once

#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <string_view>

namespace curbline::vcan {

/// One request to the kernel, with its attributes.
class LinkRequest {
 public:
  LinkRequest(unsigned short type, unsigned short flags) {
    message_.header.nlmsg_type = type;
    message_.header.nlmsg_flags = static_cast<unsigned short>(NLM_F_REQUEST | NLM_F_ACK | flags);
    message_.header.nlmsg_len = NLMSG_LENGTH(sizeof message_.link);
    message_.link.ifi_family = AF_UNSPEC;
  }
  ifinfomsg& link() { return message_.link; }

  /// Returns the attribute's position, for end_nested().
  std::size_t add(unsigned short type, const void* data, std::size_t size) {
    const std::size_t at = NLMSG_ALIGN(message_.header.nlmsg_len);
    rtattr attribute{};
    attribute.rta_type = type;
    attribute.rta_len = static_cast<unsigned short>(RTA_LENGTH(size));
    std::memcpy(bytes() + at, &attribute, sizeof attribute);
    if (size > 0) std::memcpy(bytes() + at + RTA_LENGTH(0), data, size);
    message_.header.nlmsg_len = static_cast<unsigned>(at + RTA_ALIGN(attribute.rta_len));
    return at;
  }
  std::size_t add(unsigned short type, std::string_view text) { return add(type, text.data(), text.size()); }
  void end_nested(std::size_t at) {
    const auto length = static_cast<unsigned short>(message_.header.nlmsg_len - at);
    std::memcpy(bytes() + at + offsetof(rtattr, rta_len), &length, sizeof length);
  }

  int send() {
    const int fd = ::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
    if (fd < 0) return -errno;
    struct {
      nlmsghdr header;
      nlmsgerr error;
      char rest[512];
    } answer{};
    const bool answered = ::send(fd, &message_, message_.header.nlmsg_len, 0) > 0 &&
                          ::recv(fd, &answer, sizeof answer, 0) >= static_cast<ssize_t>(NLMSG_LENGTH(sizeof(nlmsgerr)));
    const int result = answered ? answer.error.error : -errno;
    ::close(fd);
    return result;
  }

 private:
  char* bytes() { return reinterpret_cast<char*>(&message_); }
  struct {
    nlmsghdr header;
    ifinfomsg link;
    char attributes[256];
  } message_{};
};

constexpr unsigned mtu_classic = 16, mtu_fd = 72;  // sizes of can_frame and canfd_frame

/// Creates a virtual CAN interface that is up; by default it also carries CAN FD frames.
inline int make_vcan(const char* name, unsigned mtu = mtu_fd) {
  LinkRequest request(RTM_NEWLINK, NLM_F_CREATE | NLM_F_EXCL);
  request.link().ifi_flags = IFF_UP;
  request.link().ifi_change = IFF_UP;
  request.add(IFLA_IFNAME, name);
  request.add(IFLA_MTU, &mtu, sizeof mtu);
  const std::size_t info = request.add(IFLA_LINKINFO, nullptr, 0);
  request.add(IFLA_INFO_KIND, "vcan");
  request.end_nested(info);
  return request.send();
}

inline int remove_link(const char* name) {
  LinkRequest request(RTM_DELLINK, 0);
  request.link().ifi_index = static_cast<int>(::if_nametoindex(name));
  return request.link().ifi_index == 0 ? -ENODEV : request.send();
}

inline int set_link(const char* name, bool up) {
  LinkRequest request(RTM_NEWLINK, 0);
  request.link().ifi_index = static_cast<int>(::if_nametoindex(name));
  request.link().ifi_flags = up ? unsigned{IFF_UP} : 0u;
  request.link().ifi_change = IFF_UP;
  return request.link().ifi_index == 0 ? -ENODEV : request.send();
}

}  // namespace curbline::vcan
