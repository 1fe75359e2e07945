#include "formats/atomic_file.hpp"

#include <cstdio>

#include "formats_support.hpp"

using namespace curbline::tools;
using namespace curbline::tools::testing;

namespace fs = std::filesystem;

namespace {

std::size_t files_in(const TemporaryDirectory& dir) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(dir.path("")), fs::directory_iterator()));
}

}  // namespace

TEST_CASE("atomic file: nothing is left of what was not committed, and the old file stays") {
  const TemporaryDirectory dir;
  const std::string path = dir.write("a", "old");
  {
    AtomicFile file(path);
    file.stream() << "half of the n";
    file.stream().flush();
    CHECK(read_file(path) == "old");
  }
  CHECK(read_file(path) == "old");
  CHECK(files_in(dir) == 1);
}

TEST_CASE("atomic file: commit puts the whole file in place") {
  const TemporaryDirectory dir;
  AtomicFile file(dir.write("a", "old"));
  file.stream() << "new";
  file.commit();
  CHECK(read_file(dir.path("a")) == "new");
  CHECK(files_in(dir) == 1);
}

TEST_CASE("atomic file: a file that its owner alone may read stays so") {
  const TemporaryDirectory dir;
  const auto of_owner = fs::perms::owner_read | fs::perms::owner_write;
  fs::permissions(dir.write("a", "old"), of_owner);
  AtomicFile file(dir.path("a"));
  file.stream() << "new";
  file.commit();
  CHECK(read_file(dir.path("a")) == "new");
  CHECK(fs::status(dir.path("a")).permissions() == of_owner);
}

TEST_CASE("atomic file: two files for one name do not mix") {
  const TemporaryDirectory dir;
  AtomicFile first(dir.path("a")), second(dir.path("a"));
  first.stream() << "first";
  second.stream() << "second";
  second.commit();
  first.commit();
  CHECK(read_file(dir.path("a")) == "first");
}

TEST_CASE("atomic file: a symbolic link stays one, also to what is not there yet") {
  const bool there = GENERATE(true, false), relative = GENERATE(true, false);
  const TemporaryDirectory dir;
  if (there) dir.write("real", "old");
  fs::create_symlink(relative ? "real" : dir.path("real"), dir.path("link"));
  AtomicFile file(dir.path("link"));
  file.stream() << "new";
  file.commit();
  CHECK(fs::is_symlink(dir.path("link")));
  CHECK(read_file(dir.path("real")) == "new");
}

TEST_CASE("atomic file: a descriptor that leads to a file goes on where it is, and what it holds stays") {
  const TemporaryDirectory dir;
  std::FILE* const shared = std::fopen(dir.path("out").c_str(), "w");
  REQUIRE(shared != nullptr);
  const std::string number = std::to_string(::fileno(shared));
  const auto say = [&](const char* text) {
    std::fputs(text, shared);
    std::fflush(shared);
  };
  say("before\n");
  for (const std::string folder : {"/dev/fd/", "/proc/self/fd/"}) {
    AtomicFile file(folder + number);
    file.stream() << "by " + folder + "\n";
    file.commit();
  }
  say("after\n");
  std::fclose(shared);
  CHECK(read_file(dir.path("out")) == "before\nby /dev/fd/\nby /proc/self/fd/\nafter\n");
  CHECK(files_in(dir) == 1);
  CHECK(error_of([&] { AtomicFile("/dev/fd/" + number); }) ==
        number + ": cannot be written: Bad file descriptor; expected a file name in a folder to write to");
}

TEST_CASE("atomic file: a device is written to and not replaced") {
  AtomicFile file("/dev/null");
  file.stream() << "text";
  file.commit();
  CHECK(fs::is_character_file("/dev/null"));
}

TEST_CASE("atomic file: what cannot be written is refused by name") {
  const TemporaryDirectory dir;
  CHECK(error_of([&] { AtomicFile(dir.path("none/a")); }) ==
        "a: cannot be written: No such file or directory; expected a file name in a folder to write to");
  CHECK(error_of([&] { AtomicFile(dir.path(".")); }) ==
        ".: cannot be written: it is a directory; expected a file name");
}

TEST_CASE("atomic file: a full disk is an error at commit") {
  if (!fs::exists("/dev/full")) {
    WARN("SKIPPED: no /dev/full here");
    return;
  }
  AtomicFile file("/dev/full");
  file.stream() << std::string(100'000, 'x');
  CHECK(error_of([&] { file.commit(); }).find("cannot be written") != std::string::npos);
}

TEST_CASE("atomic file: what was too large for its place is refused with the reason, however it was written") {
  if (!fs::exists("/dev/full")) return;
  const std::string text(1'000'000, 'x');
  const std::string full = "/dev/full: cannot be written: No space left on device; expected room for it";
  const auto error_after = [](auto write) {
    AtomicFile file("/dev/full");
    write(file.stream());
    try {
      file.commit();
    } catch (const BadInput& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(error_after([&](std::ostream& out) { out << text; }) == full);
  CHECK(error_after([](std::ostream& out) { out << "few"; }) == full);
  CHECK(error_after([](std::ostream& out) {
          for (int k = 0; k < 100'000; ++k) out << k << '\n';
        }) == full);
}
