#include "formats/line_reader.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace curbline::tools {
namespace {

constexpr std::size_t chunk = 1 << 16;  ///< read at once

}  // namespace

LineReader::LineReader(std::string path, std::size_t max_line)
    : path_(std::move(path)),
      max_line_(max_line),
      file_(std::fopen(path_.c_str(), "rb")),
      buffer_(std::min(chunk, max_line + 1)) {
  if (!file_) throw BadInput(path_ + ": cannot be opened: " + std::strerror(errno) + "; expected a file to read");
}

/// Recognises packed files, which are common in folders of logs, so that they are not reported as malformed text.
void LineReader::check_plain() const {
  struct Packed {
    std::string_view start, by;
  };
  using namespace std::string_view_literals;
  const std::string_view start(buffer_.data() + begin_, end_ - begin_);
  for (const auto& [magic, by] :
       {Packed{"\x1F\x8B"sv, "gzip"}, {"\xFD\x37zXZ\0"sv, "xz"}, {"\x28\xB5\x2F\xFD"sv, "zstd"}}) {
    if (start.starts_with(magic))
      throw BadInput(path_ + ": compressed by " + std::string(by) + "; expected what it unpacks to");
  }
}

std::optional<std::string_view> LineReader::next() {
  if (line_ == 0 && begin_ == end_ && !at_end_) {
    fill();
    check_plain();
  }
  std::size_t searched = 0;  // bytes searched without finding a line end
  for (;;) {
    const char* const start = buffer_.data() + begin_;
    const void* const found = std::memchr(start + searched, '\n', end_ - begin_ - searched);
    if (found != nullptr) return take(static_cast<std::size_t>(static_cast<const char*>(found) - start), 1);
    searched = end_ - begin_;
    if (searched > max_line_) {
      ++line_;
      fail("line longer than " + std::to_string(max_line_) + " bytes; expected text");
    }
    if (at_end_) break;
    fill();
  }
  if (begin_ == end_) {
    if (line_ == 0) throw BadInput(path_ + ": the file is empty; expected at least one line");
    return std::nullopt;
  }
  unterminated_ = true;
  return take(end_ - begin_, 0);
}

std::string_view LineReader::take(std::size_t length, std::size_t end_bytes) {
  std::string_view line(buffer_.data() + begin_, length);
  if (line_ == 0 && line.starts_with(byte_order_mark)) line.remove_prefix(byte_order_mark.size());
  if (line.ends_with('\r')) line.remove_suffix(1);
  begin_ += length + end_bytes;
  ++line_;
  return line;
}

/// Makes room after the unread bytes, up to the longest line plus one byte, and reads once. Uses read() instead of
/// fread(), which would wait until a pipe has filled the buffer.
void LineReader::fill() {
  std::copy(buffer_.data() + begin_, buffer_.data() + end_, buffer_.data());
  end_ -= begin_;
  begin_ = 0;
  if (end_ == buffer_.size()) buffer_.resize(std::min(2 * end_, max_line_ + 1));
  ssize_t got = 0;
  do {
    got = ::read(::fileno(file_.get()), buffer_.data() + end_, std::min(chunk, buffer_.size() - end_));
  } while (got < 0 && errno == EINTR);
  if (got < 0) throw BadInput(path_ + ": cannot be read: " + std::strerror(errno) + "; expected a file to read");
  if (got == 0) at_end_ = true;
  end_ += static_cast<std::size_t>(got);
}

std::size_t LineReader::read_bytes(void* to, std::size_t bytes) {
  std::size_t read = 0;
  while (read < bytes) {
    if (begin_ == end_) {
      if (at_end_) break;
      fill();
    }
    const std::size_t ready = std::min(bytes - read, end_ - begin_);
    std::copy_n(buffer_.data() + begin_, ready, static_cast<char*>(to) + read);
    begin_ += ready;
    read += ready;
  }
  return read;
}

void LineReader::fail(const std::string& what) const {
  throw BadInput(path_, line_, unterminated_ ? what + " (the file ends within this line)" : what);
}

}  // namespace curbline::tools
