// Reads the words, numbers, strings and punctuation of a DBC file from front to back. If something else is there,
// throws BadInput with file, line and what was expected.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace curbline::tools {

class DbcScanner {
 public:
  /// `path` names the text in errors.
  DbcScanner(std::string path, std::string text) : path_(std::move(path)), text_(std::move(text)) {}

  long line() const { return line_; }  ///< of the next token, once at_end() or a call below has skipped the blanks
  bool at_end();

  /// If the mark comes next, skips it and returns true.
  bool take(char mark);
  void expect(char mark);

  /// Letters, digits and underscores, not beginning with a digit. peek_word() does not advance and returns "" for
  /// anything else.
  std::string_view peek_word();
  std::string word(const char* what);

  std::uint64_t whole(const char* what, std::uint64_t highest);
  double number(const char* what);       ///< finite
  std::string string(const char* what);  ///< in quotation marks; may span lines

  /// Skips a string or one character.
  void skip();
  /// Skips the rest of the statement, including its semicolon.
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
