// Poses as a localisation writes them: whole, in pieces, damaged, from one writer after another.
#include "pose_feed.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <string>
#include <string_view>

#include "formats/bad_input.hpp"
#include "program.hpp"

namespace curbline::daemon {
namespace {

/// A FIFO with a feed at its end.
class Fifo {
 public:
  Fifo() {
    REQUIRE(::mkfifo(path_.c_str(), 0600) == 0);
    feed.open(path_);
    connect();
  }
  ~Fifo() { ::close(writer_); }
  Fifo(const Fifo&) = delete;
  Fifo& operator=(const Fifo&) = delete;

  void write(std::string_view text) const {
    REQUIRE(::write(writer_, text.data(), text.size()) == static_cast<ssize_t>(text.size()));
  }
  /// The writer closes the FIFO, another one opens it.
  void change_writer() {
    ::close(writer_);
    connect();
  }

  PoseFeed feed;

 private:
  void connect() { writer_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC); }

  tools::testing::TemporaryDirectory directory_;
  std::string path_ = directory_.path("poses");
  int writer_ = -1;
};

/// Replaces standard input by a descriptor for a while.
class StandardInput {
 public:
  explicit StandardInput(int descriptor) : before_(::dup(STDIN_FILENO)) {
    REQUIRE(descriptor >= 0);
    REQUIRE(::dup2(descriptor, STDIN_FILENO) == STDIN_FILENO);
    ::close(descriptor);
  }
  ~StandardInput() {
    ::dup2(before_, STDIN_FILENO);
    ::close(before_);
  }
  StandardInput(const StandardInput&) = delete;
  StandardInput& operator=(const StandardInput&) = delete;

 private:
  int before_;
};

TEST_CASE("pose feed: what a line says is the pose, to the nanosecond, and nothing comes before its end") {
  Fifo fifo;
  CHECK_FALSE(fifo.feed.next());
  fifo.write("1700000000.123456789 1.5 -2 0.25  0 0 0.6 0.8");
  CHECK_FALSE(fifo.feed.next());
  fifo.write("\r\n# from here on it turns\n\n1700000001 2 0 0 0 0 0 1\n17");
  const auto pose = fifo.feed.next();
  REQUIRE(pose);
  CHECK(pose->time_ns == 1'700'000'000'123'456'789);
  CHECK(pose->x_m == 1.5f);
  CHECK(pose->y_m == -2.0f);
  CHECK(pose->z_m == 0.25f);
  CHECK(pose->qz == 0.6f);
  CHECK(pose->qw == 0.8f);
  const auto next = fifo.feed.next();
  REQUIRE(next);
  CHECK(next->time_ns == 1'700'000'001'000'000'000);
  CHECK_FALSE(fifo.feed.next());
  CHECK(fifo.feed.damaged() == 0);
}

TEST_CASE("pose feed: numbers are read as those of a trajectory's file are") {
  Fifo fifo;
  fifo.write("1.70000000025e+09 1e-50 0 0 0 0 0 1\n");
  const auto pose = fifo.feed.next();
  REQUIRE(pose);
  CHECK(pose->time_ns == 1'700'000'000'250'000'000);
  CHECK(pose->x_m == 0.0f);
}

TEST_CASE("pose feed: standard input ends with its last line, whether that has an end or not, and is not asked again") {
  std::array<int, 2> pipe{};
  REQUIRE(::pipe(pipe.data()) == 0);
  const StandardInput input(pipe[0]);
  PoseFeed feed;
  feed.open("-");
  const std::string_view text = "1700000000 0 0 0 0 0 0 1\n1700000001 0 0 0 0 0 0 1";
  REQUIRE(::write(pipe[1], text.data(), text.size()) == static_cast<ssize_t>(text.size()));
  CHECK(feed.next());
  CHECK_FALSE(feed.next());
  ::close(pipe[1]);
  CHECK(feed.next());
  CHECK_FALSE(feed.next());
  CHECK(feed.descriptor() == -1);
}

TEST_CASE("pose feed: standard input that cannot be read is not asked again, a file is refused") {
  const tools::testing::TemporaryDirectory directory;
  {
    const StandardInput input(::open("/dev/null", O_WRONLY | O_CLOEXEC));
    PoseFeed feed;
    feed.open("-");
    CHECK_FALSE(feed.next());
    CHECK(feed.descriptor() == -1);
  }
  const StandardInput input(::open(directory.write("poses.tum", "").c_str(), O_RDONLY | O_CLOEXEC));
  PoseFeed feed;
  CHECK_THROWS_AS(feed.open("-"), tools::BadInput);
}

TEST_CASE("pose feed: lines that are no poses are counted and passed over, however long") {
  Fifo fifo;
  const std::string good = "1700000000 0 0 0 0 0 0 1\n";
  const std::string_view bad[] = {"hello\n",
                                  "1700000000 0 0 0 0 0 0\n",
                                  "1700000000 0 0 0 0 0 0 1 2\n",
                                  "yesterday 0 0 0 0 0 0 1\n",
                                  "1700000000 0 0 0,5 0 0 0 1\n",
                                  "1700000000 0 0 0 1 0 0 0\n"};  // on its back, as with qw first
  std::uint64_t damaged = 0;
  for (const std::string_view line : bad) {
    INFO(line);
    fifo.write(line);
    fifo.write(good);
    CHECK(fifo.feed.next());
    CHECK_FALSE(fifo.feed.next());
    CHECK(fifo.feed.damaged() == ++damaged);
  }
  fifo.write(std::string(10'000, '1') + "\n" + good);
  CHECK(fifo.feed.next());
  CHECK(fifo.feed.damaged() == ++damaged);
}

TEST_CASE("pose feed: a writer may go and another come") {
  Fifo fifo;
  for (int writer = 0; writer < 3; ++writer) {
    fifo.write("1700000000 0 0 0 0 0 0 1\n");
    CHECK(fifo.feed.next());
    fifo.change_writer();
    CHECK_FALSE(fifo.feed.next());
    CHECK(fifo.feed.descriptor() >= 0);
  }
}

}  // namespace
}  // namespace curbline::daemon
