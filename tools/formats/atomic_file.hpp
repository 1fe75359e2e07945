// A file that is either written whole or not there: output goes to a name beside the target and takes the target's
// place at commit(). What is not committed is removed, and the file that stood there before stays.
#pragma once

#include <fstream>
#include <ostream>
#include <string>

#include "formats/bad_input.hpp"

namespace curbline::tools {

/// Keeps why a file could not be written until somebody asks: a stream says only that it could not.
class FileBuffer : public std::filebuf {
 public:
  int error() const { return error_; }  ///< the first errno; 0: none

 protected:
  int_type overflow(int_type c) override;
  std::streamsize xsputn(const char* text, std::streamsize size) override;

 private:
  int error_ = 0;
};

class AtomicFile {
 public:
  /// Throws BadInput if nothing can be written there. A target that is no file but a device or pipe (/dev/stdout) is
  /// written to directly.
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::ostream& stream() { return stream_; }

  /// Throws BadInput unless all that was written so far could be: asked of each of several files before any takes its
  /// place.
  void flush();

  /// Throws BadInput if not everything could be written: then nothing is left of it.
  void commit();

 private:
  std::string path_;       ///< as given, for errors
  std::string target_;     ///< behind symbolic links
  std::string temporary_;  ///< empty: writes to the target
  FileBuffer buffer_;
  std::ostream stream_{&buffer_};
};

/// For main(): from now on what is not committed is removed as well when a signal ends the program, Ctrl-C or a closed
/// pipe; and to write beyond the limit on a file's size is an error, not an end. Of 16 files at a time.
void remove_uncommitted_at_signals();

}  // namespace curbline::tools
