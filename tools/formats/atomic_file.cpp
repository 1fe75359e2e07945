#include "formats/atomic_file.hpp"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace curbline::tools {
namespace fs = std::filesystem;
namespace {

/// A name beside the target that no other process or AtomicFile uses.
std::string temporary_beside(const std::string& target) {
  static std::atomic<unsigned> count{0};
  return target + "." + std::to_string(::getpid()) + "-" + std::to_string(count++) + ".part";
}

std::string reason() {
  return std::string(": cannot be written: ") + std::strerror(errno) + "; expected a file name in a folder to write to";
}

}  // namespace

AtomicFile::AtomicFile(const std::string& path) : path_(path), target_(path) {
  std::error_code none;
  const fs::file_status status = fs::status(path, none);
  if (fs::is_directory(status)) throw BadInput(path_ + ": cannot be written: it is a directory; expected a file name");
  if (fs::is_symlink(path, none) && fs::is_regular_file(status)) target_ = fs::canonical(path, none).string();
  if (!fs::exists(status) || fs::is_regular_file(status)) temporary_ = temporary_beside(target_);
  errno = 0;
  stream_.open(temporary_.empty() ? target_ : temporary_, std::ios::binary);
  if (!stream_) throw BadInput(path_ + reason());
}

AtomicFile::~AtomicFile() {
  stream_.close();
  std::error_code none;
  if (!temporary_.empty()) fs::remove(temporary_, none);
}

void AtomicFile::commit() {
  errno = 0;
  stream_.close();
  if (!stream_) throw BadInput(path_ + reason());
  if (temporary_.empty()) return;
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error)
    throw BadInput(path_ + ": cannot be written: " + error.message() +
                   "; expected a file name in a folder to write to");
  temporary_.clear();
}

}  // namespace curbline::tools
