// The program with which tools/with-vcan runs a command: in its own network namespace on this kernel, or, as process 1,
// on a guest kernel whose root folder is the host's. Static and without the C++ library's I/O, for use in an initial
// RAM disk.
//
//   vcan probe                  exit status 0 if this kernel supports a vcan0
//   vcan run COMMAND...         becomes the command, in a namespace with vcan0 and lo up
//   process 1, vcan_job=FOLDER  of a guest kernel; runs the job in the folder (`directory`, `environment`, `arguments`;
//                               in the last two a zero byte ends each word), writes its exit status to FOLDER/status,
//                               turns the guest off
#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/reboot.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "link.hpp"

namespace {

using curbline::vcan::make_vcan;
using curbline::vcan::set_link;

constexpr const char* interface_name = "vcan0";

[[noreturn]] void fail(const char* what, int error) {
  std::fprintf(stderr, "with-vcan: %s: %s\n", what, std::strerror(error));
  std::exit(125);
}

bool write_text(const char* path, const std::string& text) {
  const int fd = ::open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  const bool written = fd >= 0 && ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (fd >= 0) ::close(fd);
  return written;
}

std::string read_text(const std::string& path) {
  std::string text;
  char block[4096];
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  for (ssize_t n; fd >= 0 && (n = ::read(fd, block, sizeof block)) > 0;)
    text.append(block, static_cast<std::size_t>(n));
  if (fd >= 0) ::close(fd);
  return text;
}

/// Becomes root of a network namespace: directly if permitted, otherwise in a new user namespace.
void enter_namespace() {
  const uid_t user = ::getuid();
  const gid_t group = ::getgid();
  if (::unshare(CLONE_NEWNET) == 0) return;
  if (::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) fail("no network namespace", errno);
  if (!write_text("/proc/self/setgroups", "deny") ||
      !write_text("/proc/self/uid_map", "0 " + std::to_string(user) + " 1") ||
      !write_text("/proc/self/gid_map", "0 " + std::to_string(group) + " 1")) {
    fail("no user namespace", errno);
  }
}

void make_interfaces() {
  const int can = ::socket(AF_CAN, SOCK_RAW | SOCK_CLOEXEC, 1);
  if (can < 0) fail("no CAN in this kernel", errno);
  ::close(can);
  if (const int error = make_vcan(interface_name); error != 0) fail("no vcan0 in this kernel", -error);
  set_link("lo", true);
}

int become(char** arguments) {
  ::execvp(arguments[0], arguments);
  const int error = errno;
  std::fprintf(stderr, "with-vcan: %s: %s\n", arguments[0], std::strerror(error));
  return error == ENOENT ? 127 : 126;
}

// ------ As process 1 of a guest.

void load_module(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0 || (::syscall(SYS_finit_module, fd, "", 0) != 0 && errno != EEXIST)) fail(path.c_str(), errno);
  ::close(fd);
}

/// Loads the modules listed by path, one a line, each after those that it depends on.
void load_modules(const std::string& list) {
  const std::string text = read_text(list);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    load_module(text.substr(at, end - at));
    at = end + 1;
  }
}

/// In QEMU this program is in an initial RAM disk: it mounts the host's files over 9P and makes them the root.
void enter_host_files() {
  if (::access("/modules", F_OK) != 0) return;
  load_modules("/modules");
  ::mkdir("/host", 0700);
  if (::mount("host", "/host", "9p", 0, "trans=virtio,version=9p2000.L,msize=262144,cache=mmap") != 0 ||
      ::chdir("/host") != 0 || ::mount(".", "/", nullptr, MS_MOVE, nullptr) != 0 || ::chroot(".") != 0) {
    fail("the host's files", errno);
  }
}

void start_guest() {
  ::mount("proc", "/proc", "proc", 0, nullptr);
  ::mount("sysfs", "/sys", "sysfs", 0, nullptr);
  ::mount("devtmpfs", "/dev", "devtmpfs", 0, nullptr);
  ::mkdir("/dev/shm", 0777);
  ::mkdir("/dev/pts", 0755);
  ::mount("tmpfs", "/dev/shm", "tmpfs", 0, nullptr);
  ::mount("devpts", "/dev/pts", "devpts", 0, "ptmxmode=666");
  ::mount("tmpfs", "/run", "tmpfs", 0, nullptr);
}

/// Standard output and error are terminals 0 and 1 in raw form: no carriage returns. Standard input is empty.
void open_output() {
  const char* const given = std::getenv("vcan_terminal");
  const std::string terminal = given != nullptr ? given : "/dev/tty";
  const std::string consoles[] = {"/dev/null", terminal + "0", terminal + "1"};
  for (int fd = 0; fd < 3; ++fd) {
    const int opened = ::open(consoles[fd].c_str(), (fd == 0 ? O_RDONLY : O_WRONLY) | O_NOCTTY);
    if (opened < 0) continue;
    if (opened != fd) ::dup2(opened, fd);
    if (opened > 2) ::close(opened);
    termios mode{};
    if (::tcgetattr(fd, &mode) != 0) continue;
    ::cfmakeraw(&mode);
    ::tcsetattr(fd, TCSANOW, &mode);
  }
}

/// Words of a file, each ended by a zero byte, in the form of argv and environ.
class Words {
 public:
  explicit Words(const std::string& path) : text_(read_text(path)) {
    for (std::size_t at = 0; at < text_.size(); at += std::strlen(&text_[at]) + 1) words_.push_back(&text_[at]);
    words_.push_back(nullptr);
  }
  char** get() { return words_.data(); }

 private:
  std::string text_;
  std::vector<char*> words_;
};

int run_job(const std::string& job) {
  const pid_t child = ::fork();
  if (child == 0) {
    load_modules(job + "/modules");
    make_interfaces();
    Words environment(job + "/environment"), arguments(job + "/arguments");
    environ = environment.get();
    if (::chdir(read_text(job + "/directory").c_str()) != 0) fail("the working folder", errno);
    ::setsid();
    std::exit(become(arguments.get()));
  }
  for (;;) {
    int status = 0;
    const pid_t ended = ::wait(&status);
    if (ended == child) return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    if (ended < 0 && errno != EINTR) return 125;
  }
}

int run_as_init() {
  enter_host_files();
  start_guest();
  open_output();
  const char* const job = std::getenv("vcan_job");
  if (job != nullptr) write_text((std::string(job) + "/status").c_str(), std::to_string(run_job(job)) + "\n");
  for (const int fd : {1, 2}) ::tcdrain(fd);
  ::sync();
  return ::reboot(RB_POWER_OFF);
}

}  // namespace

int main(int count, char** words) {
  if (::getpid() == 1) return run_as_init();
  const std::string mode = count > 1 ? words[1] : "";
  if (mode != "probe" && (mode != "run" || count < 3)) return 2;
  enter_namespace();
  make_interfaces();
  return mode == "probe" ? 0 : become(words + 2);
}
