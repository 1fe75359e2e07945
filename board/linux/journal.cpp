#include "journal.hpp"

#include <poll.h>
#include <unistd.h>

namespace curbline::daemon {

void JournalLine::say() {
  text_[size_++] = '\n';
  // Standard error may be closed, or a full pipe that nobody reads. The message is then lost, and the daemon continues.
  pollfd standard_error{STDERR_FILENO, POLLOUT, 0};
  if (::poll(&standard_error, 1, 0) != 1) return;
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text_.data(), size_);
}

}  // namespace curbline::daemon
