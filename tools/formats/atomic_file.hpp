// A file that is either written completely or not at all: output goes to a temporary name beside the target, which it
// replaces at commit(). Without a commit it is removed, and the previous file stays.
#pragma once

#include <ext/stdio_filebuf.h>

#include <ostream>
#include <string>

#include "formats/bad_input.hpp"

namespace curbline::tools {

/// Keeps the reason why a file could not be written: a stream only reports that it could not.
class FileBuffer : public __gnu_cxx::stdio_filebuf<char> {
 public:
  /// What a descriptor leads to, from where that is. The descriptor stays open. False, with errno, if it cannot be.
  bool open_copy(int descriptor);
  int error() const { return error_; }  ///< the first errno; 0: none

 protected:
  int_type overflow(int_type c) override;
  std::streamsize xsputn(const char* text, std::streamsize size) override;

 private:
  int error_ = 0;
};

class AtomicFile {
 public:
  /// Throws BadInput if the file cannot be written. A target that is not a file but a device or pipe is written to
  /// directly, and so is one of the program's own descriptors (/dev/stdout), whatever that leads to.
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::ostream& stream() { return stream_; }
  const std::string& path() const { return path_; }  ///< as given

  /// Throws BadInput unless everything written so far could be stored: called for each of several files before any is
  /// committed.
  void flush();

  /// Throws BadInput if not everything could be written; nothing of the file is then left.
  void commit();

 private:
  std::string path_;
  std::string target_;     ///< with symbolic links resolved
  std::string temporary_;  ///< empty: writes to the target, or to a descriptor
  FileBuffer buffer_;
  std::ostream stream_{&buffer_};
};

/// For main(): from now on, uncommitted files, 16 at a time, are also removed when a signal ends the program, such as
/// Ctrl-C or a closed pipe; and exceeding the limit on a file's size is an error instead of ending the program.
void remove_uncommitted_at_signals();

}  // namespace curbline::tools
