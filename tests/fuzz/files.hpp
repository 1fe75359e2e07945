// What fuzzers of files share: a file in memory, and what is claimed of its refusal.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <string>
#include <string_view>

#include "formats/bad_input.hpp"
#include "fuzz/claim.hpp"

namespace curbline::fuzz {

/// A file of these bytes, in memory.
class File {
 public:
  explicit File(std::string_view bytes) : descriptor_(::memfd_create("fuzz", 0)) {
    claim(descriptor_ >= 0 && ::write(descriptor_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()),
          "there is a file");
  }
  ~File() { ::close(descriptor_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

inline void check_line(const tools::BadInput& bad) {
  const std::string line = bad.what();
  claim(line.find('\n') == std::string::npos, "an error is one line");
  claim(line.find("expected") != std::string::npos, "with what was expected");
}

}  // namespace curbline::fuzz
