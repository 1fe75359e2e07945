// What the daemon writes to standard error.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <string>

namespace curbline::daemon {

/// Replaces standard error by a pipe as long as it lives.
class ErrorPipe {
 public:
  ErrorPipe() : kept_(::dup(STDERR_FILENO)) {
    REQUIRE(::pipe2(ends_.data(), O_CLOEXEC | O_NONBLOCK) == 0);
    ::dup2(ends_[1], STDERR_FILENO);
  }
  ~ErrorPipe() {
    ::dup2(kept_, STDERR_FILENO);
    for (const int fd : {kept_, ends_[0], ends_[1]}) ::close(fd);
  }

  void fill() {
    const std::array<char, 4096> bytes{};
    while (::write(ends_[1], bytes.data(), bytes.size()) > 0) {
    }
    ::fcntl(ends_[1], F_SETFL, 0);  // from now on a write blocks, as on standard error
  }
  std::string read() {
    std::array<char, 1 << 17> bytes{};
    const auto count = ::read(ends_[0], bytes.data(), bytes.size());
    return {bytes.data(), count > 0 ? static_cast<std::size_t>(count) : 0};
  }

 private:
  int kept_;
  std::array<int, 2> ends_{};
};

}  // namespace curbline::daemon
