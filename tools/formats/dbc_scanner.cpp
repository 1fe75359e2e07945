#include "formats/dbc_scanner.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "formats/ascii.hpp"
#include "formats/bad_input.hpp"

namespace curbline::tools {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool starts_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

}  // namespace

void DbcScanner::fail_at(long line, const std::string& what) const {
  throw BadInput(path_, line, what);
}

void DbcScanner::fail_expected(const std::string& what) {
  if (at_end()) fail("the file ends here; expected " + what);
  const std::size_t end = std::min(text_.find_first_of(" \t\r\n", at_), at_ + 40);
  fail(printable_ascii(text_.substr(at_, end - at_)) + "; expected " + what);
}

void DbcScanner::skip_blanks() {
  for (; at_ < text_.size() && is_blank(text_[at_]); ++at_) line_ += text_[at_] == '\n';
}

bool DbcScanner::at_end() {
  skip_blanks();
  return at_ == text_.size();
}

bool DbcScanner::take(char mark) {
  if (at_end() || text_[at_] != mark) return false;
  ++at_;
  return true;
}

void DbcScanner::expect(char mark) {
  if (!take(mark)) fail_expected(std::string("'") + mark + "'");
}

std::string_view DbcScanner::peek_word() {
  if (at_end() || !starts_word(text_[at_])) return {};
  std::size_t end = at_;
  while (end < text_.size() && (starts_word(text_[end]) || is_digit(text_[end]))) ++end;
  return std::string_view(text_).substr(at_, end - at_);
}

std::string DbcScanner::word(const char* what) {
  std::string found(peek_word());
  if (found.empty()) fail_expected(what);
  at_ += found.size();
  return found;
}

std::uint64_t DbcScanner::whole(const char* what, std::uint64_t highest) {
  std::uint64_t value = 0;
  const std::string expected = std::string(what) + ", a whole number from 0 to " + std::to_string(highest);
  if (at_end()) fail_expected(expected);
  const char* const begin = text_.data() + at_;
  const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
  if (error != std::errc() || value > highest) fail_expected(expected);
  at_ += static_cast<std::size_t>(end - begin);
  return value;
}

double DbcScanner::number(const char* what) {
  double value = 0;
  const std::string expected = std::string(what) + ", a number";
  if (at_end()) fail_expected(expected);
  const char* begin = text_.data() + at_;
  if (*begin == '+') ++begin;
  const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
  if (error != std::errc() || !std::isfinite(value)) fail_expected(expected);
  at_ = static_cast<std::size_t>(end - text_.data());
  return value;
}

std::string DbcScanner::string(const char* what) {
  if (!take('"')) fail_expected(std::string(what) + " in quotation marks");
  const long first_line = line_;
  std::string value;
  for (; at_ < text_.size() && text_[at_] != '"'; ++at_) {
    if (text_[at_] == '\\' && at_ + 1 < text_.size() && (text_[at_ + 1] == '"' || text_[at_ + 1] == '\\')) ++at_;
    line_ += text_[at_] == '\n';
    value += text_[at_];
  }
  if (at_ == text_.size()) fail_at(first_line, std::string(what) + " is not closed; expected a quotation mark");
  ++at_;
  return value;
}

void DbcScanner::skip() {
  if (at_end()) return;
  if (text_[at_] == '"') {
    string("a text");
  } else {
    ++at_;
  }
}

void DbcScanner::skip_statement() {
  const long first_line = line_;
  while (!take(';')) {
    if (at_end()) fail_at(first_line, "the statement has no end; expected ';'");
    skip();
  }
}

}  // namespace curbline::tools
