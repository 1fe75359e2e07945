// The boards' program on a platform with files: on a desk, and under qemu-user. drive IN OUT runs a drive.
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include "drive.hpp"

namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

struct Files {
  File in, out;
  std::size_t read(std::span<std::byte> bytes) { return std::fread(bytes.data(), 1, bytes.size(), in.get()); }
  bool write(std::span<const std::byte> bytes) {
    return std::fwrite(bytes.data(), 1, bytes.size(), out.get()) == bytes.size();
  }
};

curbline::Pipeline<curbline::board::limits> pipeline;

}  // namespace

int main(int count, char** words) {
  if (count != 3) return std::fprintf(stderr, "usage: %s DRIVE RESULTS\n", words[0]), 2;
  File in(std::fopen(words[1], "rb"), std::fclose);
  if (!in) {
    const char* const why = std::strerror(errno);
    return std::fprintf(stderr, "%s: cannot be read: %s; expected a stream of curbline-drive-log\n", words[1], why), 1;
  }
  File out(std::fopen(words[2], "wb"), std::fclose);
  if (!out) return std::fprintf(stderr, "%s: cannot be written: %s\n", words[2], std::strerror(errno)), 1;
  Files files{std::move(in), std::move(out)};
  curbline::board::Drive drive(files, pipeline);
  curbline::board::DriveEnd end = drive.run();
  if (std::fflush(files.out.get()) != 0) end = curbline::board::DriveEnd::no_room_for_results;
  if (end == curbline::board::DriveEnd::done) return 0;
  return std::fprintf(stderr, "%s: %s\n", words[1], to_string(end)), 1;
}
