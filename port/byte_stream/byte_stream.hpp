// Bytes over TCP or a serial line, on POSIX. Made once for an address (which looks up the host's name and may
// allocate); after that nothing is allocated, and a lost connection is opened anew by connect(). No call waits longer
// than the time it is given, but tcp() and close() as they say. Not thread-safe; not for interrupts. A serial line is
// set raw: 8 bits, no parity, no flow control.
#pragma once

#include <netdb.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace curbline::port {

using Milliseconds = std::chrono::milliseconds;

class ByteStream {
 public:
  /// A TCP server. A name may have several addresses, as localhost has ::1 and 127.0.0.1. Nothing if it cannot be
  /// looked up; `error` then says why. The look-up waits as long as the system's resolver is set to.
  static std::optional<ByteStream> tcp(const std::string& host, std::uint16_t port, std::string& error);

  /// A serial device or pty.
  static ByteStream serial(const std::string& path);

  ByteStream(ByteStream&& other) noexcept;
  ByteStream& operator=(ByteStream&& other) noexcept;
  ~ByteStream() { close(); }

  /// Opens, or opens anew: the first address that answers, in the order of the look-up. One that does not is given up
  /// when its share is over, an equal part of the time that is left. 0, or the errno of what failed, of the last
  /// address.
  int connect(Milliseconds patience);
  bool is_open() const { return fd_ >= 0; }

  /// What was written to a serial line leaves first; Linux waits for that, up to 30 s where it cannot. TCP does not
  /// wait.
  void close();

  /// Bits a second of a serial line: 9600, 19200, 38400, 57600, 115200 or 500000; any other is EINVAL. 0, or an errno.
  /// Nothing for TCP. Does not wait for bytes that are still to leave, and would garble them: call it when they have
  /// been answered.
  int set_baud(int baud);

  enum class Read : unsigned char { bytes, nothing, closed };

  /// Waits for bytes; `count` tells how many came. A signal ends the wait with nothing. Closed: by the other side, or
  /// broken.
  Read read(std::span<std::uint8_t> bytes, std::size_t& count, Milliseconds patience);

  /// Writes all of it, or closes and gives false.
  bool write(std::span<const std::uint8_t> bytes, Milliseconds patience);

  int fd() const { return fd_; }  ///< for poll(); -1 if closed

 private:
  struct FreeAddresses {
    void operator()(addrinfo* first) const { ::freeaddrinfo(first); }
  };

  ByteStream() = default;
  int connect_tcp(Milliseconds patience);
  int connect_tcp(const addrinfo& address, Milliseconds patience);
  int connect_serial();

  int fd_ = -1;
  std::string path_;  ///< of a serial line; empty: TCP
  std::unique_ptr<addrinfo, FreeAddresses> addresses_;
};

}  // namespace curbline::port
