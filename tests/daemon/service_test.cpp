// curblined as a service manager or a shell starts and stops it.
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "program.hpp"
#include "scan_log.hpp"

namespace curbline::tools::testing {
namespace {

Words arguments_of(const TemporaryDirectory& directory, int lines = 120) {  // 3 s
  return {"--robot", directory.write("fixed.toml", "[tilt]\nfixed = true\nfixed_tilt_rad = 0.5\n"),
          "--scans", daemon::write_scan_log(directory, lines),
          "--curbs", "unix:" + directory.path("curbs")};
}

/// Runs it by a line of the shell, "$0" "$@".
Outcome by_shell(const std::string& line, const TemporaryDirectory& directory) {
  return run("/bin/sh", Words{"-c", line, CURBLINE_PROGRAM} + arguments_of(directory));
}

TEST_CASE("curblined: a terminal that closes ends it as SIGTERM does, and not under nohup") {
  for (const std::string signal : {"HUP", "INT", "TERM"}) {
    INFO(signal);
    const TemporaryDirectory directory;
    const Outcome outcome = by_shell("exec timeout --preserve-status -s " + signal + " 1 \"$0\" \"$@\"", directory);
    INFO("standard error: " << outcome.err);
    CHECK(outcome.status == 0);
    CHECK(outcome.err.find("curblined: stopped by SIG" + signal + "\n") != std::string::npos);
    CHECK(outcome.out.starts_with("{\"status\":"));
    CHECK_FALSE(std::filesystem::exists(directory.path("curbs")));
  }
  const TemporaryDirectory directory;
  const Outcome outcome = by_shell(
      "exec timeout --preserve-status -s HUP 1 sh -c 'trap \"\" HUP; exec \"$0\" \"$@\"' \"$0\" \"$@\"", directory);
  INFO("standard error: " << outcome.err);
  CHECK(outcome.status == 0);
  CHECK(outcome.err.find("the log of scan lines has ended") != std::string::npos);
}

/// A socket like that on which systemd hears from its services.
class NotifySocket {
 public:
  explicit NotifySocket(const std::string& path) : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    REQUIRE(path.size() < sizeof address.sun_path);
    std::copy(path.begin(), path.end(), address.sun_path);
    REQUIRE(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    ::setenv("NOTIFY_SOCKET", path.c_str(), 1);
  }
  ~NotifySocket() {
    ::unsetenv("NOTIFY_SOCKET");
    ::close(socket_);
  }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  Words heard() const {
    Words all;
    std::array<char, 256> text{};
    for (ssize_t got; (got = ::recv(socket_, text.data(), text.size(), MSG_DONTWAIT)) > 0;)
      all.emplace_back(text.data(), static_cast<std::size_t>(got));
    return all;
  }

 private:
  int socket_;
};

TEST_CASE("curblined: it tells systemd that it is ready, alive once a second, how it is, and that it stops") {
  const TemporaryDirectory directory;
  const NotifySocket systemd(directory.path("notify"));
  REQUIRE(curbline(arguments_of(directory)).status == 0);
  const Words heard = systemd.heard();
  REQUIRE(heard.size() >= 4);
  CHECK(heard.front() == "READY=1");
  CHECK(heard.back() == "STOPPING=1");
  CHECK(std::count(heard.begin(), heard.end(), "STATUS=ok") >= 1);
  CHECK(std::count(heard.begin(), heard.end(), "WATCHDOG=1") >= 2);
}

/// All that a client reads, from when the daemon listens until it closes the connection.
std::string read_all(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  REQUIRE(path.size() < sizeof address.sun_path);
  std::copy(path.begin(), path.end(), address.sun_path);
  const int client = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  bool connected = false;
  for (int i = 0; i < 500 && !connected; ++i) {
    connected = ::connect(client, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    if (!connected) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  CHECK(connected);
  std::string text;
  std::array<char, 4096> some{};
  for (ssize_t got; connected && (got = ::read(client, some.data(), some.size())) > 0;)
    text.append(some.data(), static_cast<std::size_t>(got));
  ::close(client);
  return text;
}

TEST_CASE("curblined: the last that a client hears is how it was at the end") {
  const TemporaryDirectory directory;
  Outcome outcome;
  std::thread running([&] { outcome = curbline(arguments_of(directory, 100)); });  // 2.5 s: between two of each second
  const Words heard = lines_of(read_all(directory.path("curbs")));
  running.join();
  REQUIRE(outcome.status == 0);
  REQUIRE(heard.size() >= 2);
  const auto lines_in = [](const std::string& line) {
    return nlohmann::json::parse(line).at("status").at("pipeline").at("lines").get<int>();
  };
  CHECK(lines_in(heard.front()) < 100);
  CHECK(lines_in(heard.back()) == 100);
  CHECK(lines_in(outcome.out) == 100);
}

}  // namespace
}  // namespace curbline::tools::testing
