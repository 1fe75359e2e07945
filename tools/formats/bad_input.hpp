// The exception with which all tools report bad input.
#pragma once

#include <stdexcept>
#include <string>

namespace curbline::tools {

/// what() is the complete line for stderr: "FILE:LINE: what is wrong; expected ...". main() prints it and exits with 1.
class BadInput : public std::runtime_error {
 public:
  explicit BadInput(const std::string& what) : std::runtime_error(what) {}
  BadInput(const std::string& file, long line, const std::string& what)
      : std::runtime_error(file + ":" + std::to_string(line) + ": " + what) {}
};

}  // namespace curbline::tools
