// Words that count in small letters and capitals: endings of files, names of columns. ASCII, without locale.
#pragma once

#include <string>

namespace curbline::tools {

inline std::string lower_case(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

}  // namespace curbline::tools
