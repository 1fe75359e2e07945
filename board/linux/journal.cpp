#include "journal.hpp"

#include <unistd.h>

namespace curbline::daemon {

void JournalLine::say() {
  text_[size_++] = '\n';
  // Standard error may be closed or full: then nobody listens, and the daemon goes on.
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text_.data(), size_);
}

}  // namespace curbline::daemon
