#include "formats/line_reader.hpp"

#include <string>
#include <vector>

#include "formats_support.hpp"

using namespace curbline::tools;
using namespace curbline::tools::testing;

namespace {

std::vector<std::string> lines_of(const std::string& path, std::size_t max_line = LineReader::default_max_line) {
  LineReader source(path, max_line);
  std::vector<std::string> lines;
  while (const auto line = source.next()) lines.emplace_back(*line);
  return lines;
}

}  // namespace

TEST_CASE("line reader: a compressed file is told as such, not as text that is wrong") {
  const TemporaryDirectory dir;
  const auto error = [&](const std::string& bytes) {
    return error_of([&] { LineReader(dir.write("a.log", bytes)).next(); });
  };
  CHECK(error("\x1F\x8B\x08") == "a.log: compressed by gzip; expected what it unpacks to");
  CHECK(error(std::string("\xFD\x37zXZ\0", 6)) == "a.log: compressed by xz; expected what it unpacks to");
  CHECK(error("\x28\xB5\x2F\xFD") == "a.log: compressed by zstd; expected what it unpacks to");
}

TEST_CASE("line reader: a byte order mark is no part of the first line") {
  const TemporaryDirectory dir;
  const std::string mark = "\xEF\xBB\xBF";
  CHECK(lines_of(dir.write("a", mark + "one\n" + mark + "two\n")) == std::vector<std::string>{"one", mark + "two"});
  CHECK(lines_of(dir.write("a", mark + "\r\n")) == std::vector<std::string>{""});
  CHECK(lines_of(dir.write("a", mark)) == std::vector<std::string>{""});
}

TEST_CASE("line reader: lines come one by one, whatever their end") {
  const TemporaryDirectory dir;
  CHECK(lines_of(dir.write("a", "one\ntwo\r\n\nlast")) == std::vector<std::string>{"one", "two", "", "last"});
}

TEST_CASE("line reader: lines across the reading buffer are whole") {
  const TemporaryDirectory dir;
  std::string text;
  std::vector<std::string> expected;
  for (int i = 0; i < 5000; ++i) {
    expected.push_back(std::string(static_cast<std::size_t>(i % 97), 'x') + std::to_string(i));
    text += expected.back() + "\n";
  }
  CHECK(lines_of(dir.write("a", text)) == expected);
  CHECK(lines_of(dir.path("a"), 101) == expected);
}

TEST_CASE("line reader: a line over the bound is refused, one at the bound is not") {
  const TemporaryDirectory dir;
  const std::string path = dir.write("a", "short\n" + std::string(100, 'x') + "\n");
  CHECK(lines_of(path, 100).size() == 2);
  CHECK(error_of([&] { lines_of(path, 99); }) == "a:2: line longer than 99 bytes; expected text");
}

TEST_CASE("line reader: a file without line ends is not read into memory") {
  CHECK(error_of([] { lines_of("/dev/zero"); }).find("longer than") != std::string::npos);
}

TEST_CASE("line reader: missing, empty and unreadable files are refused by name") {
  const TemporaryDirectory dir;
  CHECK(error_of([&] { lines_of(dir.path("none")); }) ==
        "none: cannot be opened: No such file or directory; expected a file to read");
  CHECK(error_of([&] { lines_of(dir.write("empty", "")); }) == "empty: the file is empty; expected at least one line");
  CHECK(error_of([&] { lines_of(dir.path("")); }).find("cannot be read: Is a directory") != std::string::npos);
}

TEST_CASE("line reader: an error in a last line without an end says that the file ends there") {
  const TemporaryDirectory dir;
  LineReader source(dir.write("a", "one\ntwo"));
  source.next();
  CHECK(error_of([&] { source.fail("bad; expected good"); }) == "a:1: bad; expected good");
  source.next();
  CHECK(error_of([&] { source.fail("bad; expected good"); }) ==
        "a:2: bad; expected good (the file ends within this line)");
}

TEST_CASE("line reader: bytes behind the last line are read from where it ended") {
  const TemporaryDirectory dir;
  const std::string bytes(100'000, '\7');
  LineReader source(dir.write("a", "head\n" + bytes));
  source.next();
  std::string got(bytes.size(), ' ');
  CHECK(source.read_bytes(got.data(), got.size()) == got.size());
  CHECK(got == bytes);
  CHECK(source.read_bytes(got.data(), 1) == 0);
}
