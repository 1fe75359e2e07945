#include "formats/atomic_file.hpp"

#include <signal.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>

#include "formats/parse_number.hpp"

namespace curbline::tools {
namespace fs = std::filesystem;
namespace {

/// A name beside the target that no other process or AtomicFile uses.
std::string temporary_beside(const std::string& target) {
  static std::atomic<unsigned> count{0};
  return target + "." + std::to_string(::getpid()) + "-" + std::to_string(count++) + ".part";
}

/// Where a name leads, along symbolic links: also to a file that is not there yet, or to a descriptor of this process.
struct Target {
  fs::path path;
  std::optional<int> descriptor{};
};

Target target_of(fs::path path) {
  constexpr int most_links = 40;  // as the kernel's
  std::error_code none;
  for (int links = 0; links < most_links; ++links) {
    if (fs::equivalent(path.parent_path(), "/proc/self/fd", none))
      return {path, parse_number<int>(path.filename().native())};
    if (!fs::is_symlink(path, none)) break;
    path = path.parent_path() / fs::read_symlink(path, none);
  }
  return {path};
}

/// Names of uncommitted files, for the signal handler; null for a free place.
std::array<std::atomic<const char*>, 16> uncommitted{};
static_assert(std::atomic<const char*>::is_always_lock_free);

/// Replaces the name in the first place that contains it.
void replace(const char* name, const char* by) {
  for (auto& place : uncommitted) {
    const char* expected = name;
    if (place.compare_exchange_strong(expected, by)) return;
  }
}

/// The signal is raised again for its default action, which follows when the handler returns. SA_RESETHAND is no
/// alternative: a second signal that arrives before the handler of the first has begun would act at once.
void remove_uncommitted(int signal) {
  for (const auto& place : uncommitted) {
    if (const char* const name = place) ::unlink(name);
  }
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

std::string reason(int error) {
  const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  return std::string(": cannot be written: ") + std::strerror(error) + "; expected " +
         (full ? "room for it" : "a file name in a folder to write to");
}

}  // namespace

bool FileBuffer::open_copy(int descriptor) {
  const int copy = ::dup(descriptor);
  if (copy < 0) return false;
  static_cast<stdio_filebuf&>(*this) = stdio_filebuf(copy, std::ios::out | std::ios::binary);
  if (!is_open()) ::close(copy);
  return is_open();
}

FileBuffer::int_type FileBuffer::overflow(int_type c) {
  errno = 0;
  const int_type done = stdio_filebuf::overflow(c);
  if (done == traits_type::eof() && error_ == 0) error_ = errno;
  return done;
}

std::streamsize FileBuffer::xsputn(const char* text, std::streamsize size) {
  errno = 0;
  const std::streamsize done = stdio_filebuf::xsputn(text, size);
  if (done != size && error_ == 0) error_ = errno;
  return done;
}

AtomicFile::AtomicFile(const std::string& path) : path_(path) {
  const auto [target, descriptor] = target_of(path);
  target_ = target;
  errno = 0;
  if (descriptor) {
    if (!buffer_.open_copy(*descriptor)) throw BadInput(path_ + reason(errno));
    return;
  }
  std::error_code none;
  const fs::file_status status = fs::status(target, none);
  if (fs::is_directory(status)) throw BadInput(path_ + ": cannot be written: it is a directory; expected a file name");
  if (!fs::exists(status) || fs::is_regular_file(status)) temporary_ = temporary_beside(target_);
  if (!temporary_.empty()) replace(nullptr, temporary_.c_str());
  errno = 0;
  if (buffer_.open(temporary_.empty() ? target_ : temporary_, std::ios::out | std::ios::binary) == nullptr) {
    replace(temporary_.c_str(), nullptr);
    throw BadInput(path_ + reason(errno));
  }
  if (fs::is_regular_file(status)) fs::permissions(temporary_, status.permissions() & fs::perms::all, none);
}

AtomicFile::~AtomicFile() {
  buffer_.close();
  std::error_code none;
  if (!temporary_.empty()) fs::remove(temporary_, none);
  replace(temporary_.c_str(), nullptr);
}

void AtomicFile::flush() {
  if (!stream_.flush()) throw BadInput(path_ + reason(buffer_.error()));
}

void AtomicFile::commit() {
  flush();
  errno = 0;
  if (buffer_.close() == nullptr) throw BadInput(path_ + reason(errno));
  if (temporary_.empty()) return;
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) throw BadInput(path_ + reason(error.value()));
  replace(temporary_.c_str(), nullptr);
  temporary_.clear();
}

void remove_uncommitted_at_signals() {
  struct sigaction remove {};
  remove.sa_handler = remove_uncommitted;
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGPIPE, SIGXCPU}) {
    struct sigaction before {};
    ::sigaction(signal, &remove, &before);
    if (before.sa_handler == SIG_IGN) ::sigaction(signal, &before, nullptr);
  }
  ::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace curbline::tools
