// Files for tests, written to a separate directory that is removed at the end, and the errors from reading them.
#pragma once

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>

#include "formats/bad_input.hpp"

namespace curbline::tools::testing {

class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string pattern = (std::filesystem::temp_directory_path() / "curbline-test-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary directory");
    path_ = pattern;
  }
  ~TemporaryDirectory() {
    std::error_code none;
    std::filesystem::remove_all(path_, none);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  std::string path(const std::string& name) const { return path_ + "/" + name; }

  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  }

 private:
  std::string path_;
};

inline std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline bool says_what_was_expected(const BadInput& error) {
  return std::string(error.what()).find("expected") != std::string::npos;
}

/// The message of BadInput, without the directory; empty if nothing is thrown. CHECKs that it says what was expected.
inline std::string error_of(const std::function<void()>& read) {
  try {
    read();
  } catch (const BadInput& error) {
    CHECK(says_what_was_expected(error));
    const std::string what = error.what();
    const std::size_t name = what.substr(0, what.find(": ")).rfind('/');
    return name == std::string::npos ? what : what.substr(name + 1);
  }
  return {};
}

/// Reads thousands of damaged copies of a good file. Each must be accepted or refused with BadInput; nothing else may
/// happen.
inline void survive_damage(const std::string& good, const std::string& file_name,
                           const std::function<void(const std::string&)>& read, int trials = 2000) {
  const TemporaryDirectory directory;
  std::mt19937 random(7);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % (n == 0 ? 1 : n); };
  static const std::string likely = "0123456789.-+eE#, \n\t\"=[]xXNnaAiIfFR()\0\xFF";
  int refused = 0;
  for (int trial = 0; trial < trials; ++trial) {
    std::string text = good;
    for (std::size_t edits = 1 + below(4); edits > 0; --edits) {
      const std::size_t at = below(text.size());
      switch (random() % 5) {
        case 0:
          text.resize(at);
          break;
        case 1:
          text.erase(at, 1 + below(20));
          break;
        case 2:
          text.insert(at, 1, likely[below(likely.size())]);
          break;
        case 3:
          text.insert(at, text.substr(below(text.size()), below(40)));
          break;
        default:
          if (!text.empty()) text[at] = static_cast<char>(random());
      }
    }
    const std::string path = directory.write(file_name, text);
    try {
      read(path);
    } catch (const BadInput& error) {
      ++refused;
      if (std::string(error.what()).find('\n') != std::string::npos) FAIL("more than one line: " << error.what());
      if (std::string(error.what()).rfind(path, 0) != 0) FAIL("without the file's name: " << error.what());
      if (!says_what_was_expected(error)) FAIL("without what was expected: " << error.what());
    }
  }
  CHECK(refused > 0);
}

}  // namespace curbline::tools::testing
