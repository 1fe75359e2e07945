// Reads a file line by line, for all text formats. Memory is bounded by the longest line allowed, not by the file;
// lines from a pipe are returned as they come.
#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/bad_input.hpp"

namespace curbline::tools {

inline constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  ///< of UTF-8, which spreadsheets write first

class LineReader {
 public:
  /// A scan line of 1081 ranges has 10 kB; a line longer than this means that the file is not text of the expected
  /// format.
  static constexpr std::size_t default_max_line = std::size_t{1} << 20;

  /// Throws BadInput if the file cannot be opened.
  explicit LineReader(std::string path, std::size_t max_line = default_max_line);

  /// The next line without its end (LF or CR LF), the first without UTF-8's byte order mark; valid until the next call;
  /// nothing at the end of the file. Throws BadInput if the line is too long, the file is empty or compressed, or
  /// reading fails.
  std::optional<std::string_view> next();

  /// Reads the bytes after the last line, for formats with a text header. How many: fewer where the file ends.
  std::size_t read_bytes(void* to, std::size_t bytes);

  const std::string& path() const { return path_; }
  long line() const { return line_; }  ///< number of the last line returned, from 1

  /// Throws BadInput for the last line returned, and says so if the file ends within it.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  void fill();
  void check_plain() const;
  std::string_view take(std::size_t length, std::size_t end_bytes);

  std::string path_;
  std::size_t max_line_;
  std::unique_ptr<std::FILE, Close> file_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;  ///< the bytes read and not yet returned
  long line_ = 0;
  bool at_end_ = false;
  bool unterminated_ = false;  ///< the last line returned had no line end
};

}  // namespace curbline::tools
