#include "service.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "formats/can_log.hpp"

extern char** environ;

namespace curbline::tools::testing {
namespace {

using namespace std::chrono_literals;

/// Waits until `what` is true, for at most 10 s.
bool comes_true(const std::function<bool()>& what) {
  for (int i = 0; i < 500; ++i) {
    if (what()) return true;
    std::this_thread::sleep_for(20ms);
  }
  return false;
}

int connect_to(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  REQUIRE(path.size() < sizeof address.sun_path);
  std::copy(path.begin(), path.end(), address.sun_path);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return socket;
  ::close(socket);
  return -1;
}

}  // namespace

Service::Service(const Words& arguments) {
  Words words{CURBLINED};
  words = words + arguments + Words{"--curbs", "unix:" + socket()};
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  const int flags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, directory_.path("out").c_str(), flags, 0600);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, directory_.path("err").c_str(), flags, 0600);
  REQUIRE(::posix_spawn(&process_, CURBLINED, &files, nullptr, argv.data(), environ) == 0);
  posix_spawn_file_actions_destroy(&files);
  const bool ready = says("ready");
  INFO("standard error: " << said());
  REQUIRE(ready);
  client_ = connect_to(socket());
  REQUIRE(client_ >= 0);
  reader_ = std::thread([this] { read_lines(); });
  REQUIRE(gives([](const nlohmann::json& line) { return line.contains("status"); }));
}

Service::~Service() {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    end();
  }
}

void Service::read_lines() {
  std::string text;
  std::array<char, 65536> some{};
  for (ssize_t got; (got = ::read(client_, some.data(), some.size())) > 0;) {
    text.append(some.data(), static_cast<std::size_t>(got));
    for (std::size_t end; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1)) {
      const std::lock_guard lock(mutex_);
      lines_.push_back(nlohmann::json::parse(text.substr(0, end)));
    }
  }
}

bool Service::gives(const std::function<bool(const nlohmann::json&)>& wanted) const {
  return comes_true([&] {
    const std::lock_guard lock(mutex_);
    return std::any_of(lines_.begin(), lines_.end(), wanted);
  });
}

bool Service::says(const std::string& words) const {
  return comes_true([&] { return times_said(said(), words) > 0; });
}

void Service::signal(int number) const {
  REQUIRE(::kill(process_, number) == 0);
}

Outcome Service::end() {
  Outcome outcome;
  int status = 0;
  const bool ended = comes_true([&] { return ::waitpid(process_, &status, WNOHANG) == process_; });
  if (!ended) {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, &status, 0);
  }
  process_ = -1;
  if (reader_.joinable()) reader_.join();
  if (client_ >= 0) ::close(client_);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  outcome.out = read_file(directory_.path("out"));
  outcome.err = said();
  return outcome;
}

std::vector<nlohmann::json> Service::lines() const {
  const std::lock_guard lock(mutex_);
  return lines_;
}

int times_said(const std::string& text, const std::string& words) {
  int times = 0;
  for (std::size_t at = 0; (at = text.find(words, at)) != std::string::npos; at += words.size()) ++times;
  return times;
}

std::vector<nlohmann::json> distinct_curbs(const std::vector<nlohmann::json>& lines) {
  std::vector<nlohmann::json> distinct;
  std::set<std::string> seen;
  for (const nlohmann::json& line : lines) {
    if (!line.contains("curbs")) continue;
    for (const nlohmann::json& curb : line.at("curbs")) {
      if (seen.insert(curb.dump()).second) distinct.push_back(curb);
    }
  }
  return distinct;
}

std::vector<nlohmann::json> replayed_curbs(const Words& replay) {
  const Outcome outcome = curbline(replay + Words{"--curbs", "-"});
  INFO("standard error: " << outcome.err);
  REQUIRE(outcome.status == 0);
  nlohmann::json all = nlohmann::json::array();
  for (const std::string& line : lines_of(outcome.out)) all.push_back(nlohmann::json::parse(line));
  return distinct_curbs({{{"curbs", all}}});
}

void check_same(const std::vector<nlohmann::json>& curbs, const std::vector<nlohmann::json>& wanted) {
  const auto [mine, theirs] = std::mismatch(curbs.begin(), curbs.end(), wanted.begin(), wanted.end());
  const auto text = [](auto at, auto end) { return at == end ? std::string("the end") : at->dump(); };
  INFO("the first that differs, after " << mine - curbs.begin() << " of " << wanted.size() << ": "
                                        << text(mine, curbs.end()) << "; wanted " << text(theirs, wanted.end()));
  CHECK((mine == curbs.end() && theirs == wanted.end()));
}

nlohmann::json last_curbs(const std::vector<nlohmann::json>& lines) {
  nlohmann::json last;
  for (const nlohmann::json& line : lines) {
    if (line.contains("curbs")) last = line.at("curbs");
  }
  return last;
}

void check_alike(const nlohmann::json& curbs, const nlohmann::json& wanted) {
  INFO("curbs: " << curbs << "\nwanted: " << wanted);
  REQUIRE(curbs.size() == wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    CHECK(curbs[i].at("kind") == wanted[i].at("kind"));
    for (const char* place : {"x0_m", "y0_m", "x1_m", "y1_m"}) {
      CHECK(curbs[i].at(place).get<double>() == Approx(wanted[i].at(place).get<double>()).margin(0.05));
    }
    CHECK(curbs[i].at("height_m").get<double>() == Approx(wanted[i].at("height_m").get<double>()).margin(0.005));
  }
}

void play(const std::string& log, const Send& send) {
  socketcan::SocketCan bus;
  REQUIRE(bus.open("vcan0", {}) == socketcan::Status::ok);
  CanLogReader reader(log);
  std::optional<std::int64_t> first_ns;
  const auto start = std::chrono::steady_clock::now();
  while (const auto frame = reader.next()) {
    if (!first_ns) first_ns = frame->time_ns;
    const auto since = std::chrono::nanoseconds(frame->time_ns - *first_ns);
    std::this_thread::sleep_until(start + since);
    send(bus, *frame, 1e-9 * static_cast<double>(since.count()));
  }
}

}  // namespace curbline::tools::testing
