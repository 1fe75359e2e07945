// Bytes over TCP or a serial line, on POSIX. An object is created for an address, which looks up the host's name and
// may allocate; after that nothing is allocated, and connect() reopens a lost connection. No call waits longer than the
// time that it is given, with the exceptions documented at tcp() and close(). Not thread-safe; not for interrupts. A
// serial line is locked (flock: EBUSY where another program has done so) and set to raw mode: 8 bits, no parity, no
// flow control.
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
  /// A TCP server. A name may have several addresses; localhost has ::1 and 127.0.0.1. Nothing if the look-up fails;
  /// `error` then gives the reason. The look-up takes as long as the system's resolver is configured to wait.
  static std::optional<ByteStream> tcp(const std::string& host, std::uint16_t port, std::string& error);

  /// A serial device or pty.
  static ByteStream serial(const std::string& path);

  ByteStream(ByteStream&& other) noexcept;
  ByteStream& operator=(ByteStream&& other) noexcept;
  ~ByteStream() { close(); }

  /// Opens or reopens: connects to the first address that answers, in the order of the look-up. Each address gets an
  /// equal share of the remaining time, after which it is given up. Returns 0, or the errno of the failure of the last
  /// address.
  int connect(Milliseconds patience);
  bool is_open() const { return fd_ >= 0; }

  /// On a serial line, written bytes are sent first; Linux waits for that, up to 30 s if they cannot be sent. TCP does
  /// not wait.
  void close();

  /// Bits a second of a serial line: 9600, 19200, 38400, 57600, 115200 or 500000; others return EINVAL. Returns 0 or an
  /// errno. No effect on TCP. Does not wait for unsent bytes and would garble them: call it only after they have been
  /// answered.
  int set_baud(int baud);

  enum class Read : unsigned char { bytes, nothing, closed };

  /// Waits for bytes; `count` is their number. A signal ends the wait without bytes. Closed: by the other side, or
  /// broken.
  Read read(std::span<std::uint8_t> bytes, std::size_t& count, Milliseconds patience);

  /// Writes everything, or closes and returns false.
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
  std::string path_;  ///< path of a serial line; empty: TCP
  std::unique_ptr<addrinfo, FreeAddresses> addresses_;
};

}  // namespace curbline::port
