#include "pose_feed.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "formats/bad_input.hpp"
#include "formats/trajectory.hpp"

namespace curbline::daemon {

using tools::BadInput;

PoseFeed::~PoseFeed() {
  close();
}

/// Standard input stays open, because it belongs to the process.
void PoseFeed::close() {
  if (descriptor_ > STDERR_FILENO) ::close(descriptor_);
  descriptor_ = -1;
}

void PoseFeed::open(const std::string& source) {
  if (source == "-") {
    struct stat input {};
    if (::fstat(STDIN_FILENO, &input) == 0 && S_ISREG(input.st_mode))
      throw BadInput("standard input: a file; expected a pipe, or the file's name");
    descriptor_ = STDIN_FILENO;
    return;
  }
  // Opened for writing too: otherwise the FIFO would stay at its end after the last writer closes it.
  descriptor_ = ::open(source.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (descriptor_ < 0) throw BadInput(source + ": " + std::strerror(errno) + "; expected a FIFO to read and write");
}

std::optional<Pose> PoseFeed::next() {
  for (;;) {
    while (const auto line = next_line()) {
      if (line->find_first_not_of(" \t\r") == line->npos || line->starts_with('#')) continue;
      if (const auto pose = tools::parse_pose(*line)) return pose;
      ++damaged_;
    }
    if (!fill()) return std::nullopt;
  }
}

/// The next line of what has been read. A line longer than the buffer is damaged.
std::optional<std::string_view> PoseFeed::next_line() {
  const std::string_view read(buffer_.data() + begin_, end_ - begin_);
  const std::size_t length = read.find('\n');
  if (length == read.npos) {
    const bool full = read.size() == buffer_.size();
    if (full && !skipping_) ++damaged_;
    skipping_ = skipping_ || full;
    if (skipping_) begin_ = end_;
    return std::nullopt;
  }
  begin_ += length + 1;
  if (!skipping_) return read.substr(0, length);
  skipping_ = false;
  return std::string_view{};
}

/// Reads what is available. False if nothing is.
bool PoseFeed::fill() {
  pollfd ready{descriptor_, POLLIN, 0};  // because standard input, which is shared with other processes, may block
  if (descriptor_ < 0 || ::poll(&ready, 1, 0) <= 0) return false;
  std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_), buffer_.begin() + static_cast<std::ptrdiff_t>(end_),
            buffer_.begin());
  end_ -= begin_;
  begin_ = 0;
  const ssize_t got = ::read(descriptor_, buffer_.data() + end_, buffer_.size() - end_);
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return false;
  if (got <= 0) {  // standard input has ended, or cannot be read
    close();
    if (end_ == 0) return false;
    buffer_[end_++] = '\n';  // the end of its last line
    return true;
  }
  end_ += static_cast<std::size_t>(got);
  return true;
}

}  // namespace curbline::daemon
