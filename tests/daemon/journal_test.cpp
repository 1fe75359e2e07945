// What the daemon writes to standard error, whether or not anyone reads it.
#include "journal.hpp"

#include <chrono>
#include <thread>

#include "error_pipe.hpp"

namespace curbline::daemon {
namespace {

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

TEST_CASE("journal: a trouble is news when it begins, and again after ten seconds without it") {
  constexpr std::int64_t s = 1'000'000'000;
  Trouble trouble;
  CHECK_FALSE(trouble.is_news(0, 0));
  CHECK(trouble.is_news(1, 1 * s));
  CHECK_FALSE(trouble.is_news(1, 2 * s));
  CHECK_FALSE(trouble.is_news(5, 10 * s));  // it continues
  CHECK_FALSE(trouble.is_news(6, 19 * s));
  CHECK_FALSE(trouble.is_news(6, 60 * s));
  CHECK(trouble.is_news(7, 61 * s));
}

}  // namespace
}  // namespace curbline::daemon
