// The words, numbers, strings and marks of a DBC file, read from front to back. What is not there as expected throws
// BadInput with file, line and what was expected.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace curbline::tools {

class DbcScanner {
 public:
  /// `path` is how errors call the text.
  DbcScanner(std::string path, std::string text) : path_(std::move(path)), text_(std::move(text)) {}

  long line() const { return line_; }  ///< of what comes next, once at_end() or a call below has passed the blanks
  bool at_end();

  /// True, and past it, if the mark comes next.
  bool take(char mark);
  void expect(char mark);

  /// Letters, digits and underscores, not beginning with a digit. peek_word() does not go past it and gives "" for
  /// anything else.
  std::string_view peek_word();
  std::string word(const char* what);

  std::uint64_t whole(const char* what, std::uint64_t highest);
  double number(const char* what);       ///< finite
  std::string string(const char* what);  ///< in quotation marks; may go over lines

  /// Past what comes next, a string or one character: to leave out what nobody asks for.
  void skip();
  /// Past the statement's semicolon.
  void skip_statement();

  [[noreturn]] void fail(const std::string& what) const { fail_at(line_, what); }
  [[noreturn]] void fail_at(long line, const std::string& what) const;

 private:
  void skip_blanks();
  [[noreturn]] void fail_expected(const std::string& what);

  std::string path_, text_;
  std::size_t at_ = 0;
  long line_ = 1;
};

}  // namespace curbline::tools
