// What the daemon writes to standard error, whether or not anyone reads it.
#include "journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <chrono>
#include <string>
#include <thread>

namespace curbline::daemon {
namespace {

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

TEST_CASE("journal: a line is the words and numbers that it was made of") {
  ErrorPipe standard_error;
  say("lines: ", 12, " of ", "many");
  CHECK(standard_error.read() == "curblined: lines: 12 of many\n");
}

TEST_CASE("journal: a reader of standard error that stops does not stop the daemon") {
  using Clock = std::chrono::steady_clock;
  std::chrono::duration<double> waited{};
  {
    ErrorPipe standard_error;
    standard_error.fill();
    std::thread reader([&] {  // reads in the end, so that a failing test ends too
      std::this_thread::sleep_for(std::chrono::seconds(1));
      standard_error.read();
    });
    const auto before = Clock::now();
    say("nobody reads this");
    waited = Clock::now() - before;
    reader.join();
    say("somebody reads again");
    CHECK(standard_error.read().find("somebody reads again") != std::string::npos);
  }
  CHECK(waited.count() < 0.5);
}

}  // namespace
}  // namespace curbline::daemon
