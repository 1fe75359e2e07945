// Helpers for ASCII text, without locale.
#pragma once

#include <string>
#include <string_view>

namespace curbline::tools {

/// For words whose case does not matter: endings of files, names of columns.
inline std::string lower_case(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

/// Replaces each byte that is not printable ASCII by "?": for one line of a message or a comment.
inline std::string printable_ascii(std::string_view text) {
  std::string out;
  for (const char c : text) out += c >= ' ' && c <= '~' ? c : '?';
  return out;
}

}  // namespace curbline::tools
