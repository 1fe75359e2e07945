// Converts the kernel's frames to ours and back; part of socketcan.cpp.
#pragma once

#include <linux/can.h>

#include <algorithm>
#include <cstdint>

#include "curbline/can/frame.hpp"

namespace curbline::socketcan {

inline can::Frame to_frame(const canfd_frame& from, bool fd, std::int64_t time_ns) {
  can::Frame out;
  out.time_ns = time_ns;
  out.extended = (from.can_id & CAN_EFF_FLAG) != 0;
  out.remote = (from.can_id & CAN_RTR_FLAG) != 0;
  out.id = from.can_id & (out.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  out.fd = fd;
  out.fd_flags = fd ? from.flags & (CANFD_BRS | CANFD_ESI) : std::uint8_t{0};
  out.length = std::min<std::uint8_t>(from.len, fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN);
  std::copy_n(from.data, out.length, out.data.begin());
  return out;
}

inline canfd_frame from_frame(const can::Frame& from) {
  canfd_frame out{};
  out.can_id = from.id | (from.extended ? CAN_EFF_FLAG : 0) | (from.remote ? CAN_RTR_FLAG : 0);
  out.len = from.length;
  out.flags = from.fd ? from.fd_flags & (CANFD_BRS | CANFD_ESI) : std::uint8_t{0};
  std::copy_n(from.data.begin(), from.length, out.data);
  return out;
}

}  // namespace curbline::socketcan
