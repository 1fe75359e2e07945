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
  int write_error = 0;                      ///< errno
  std::size_t bytes_read = 0, missing = 0;  ///< missing: of the last read
  std::size_t read(std::span<std::byte> bytes) {
    const std::size_t got = std::fread(bytes.data(), 1, bytes.size(), in.get());
    bytes_read += got;
    missing = bytes.size() - got;
    return got;
  }
  bool write(std::span<const std::byte> bytes) {
    return keep_error(std::fwrite(bytes.data(), 1, bytes.size(), out.get()) == bytes.size());
  }
  bool flush() { return keep_error(std::fflush(out.get()) == 0); }

 private:
  bool keep_error(bool written) {
    if (!written && write_error == 0) write_error = errno;
    return written;
  }
};

/// The setting that the pipeline has refused, by reading it once more; nullptr of a pipe, which cannot be.
const char* refused_setting(std::FILE* in) {
  curbline::drive_log::Setup setup;
  if (std::fseek(in, sizeof(curbline::drive_log::RecordHeader), SEEK_SET) != 0) return nullptr;
  if (std::fread(&setup, sizeof setup, 1, in) != 1) return nullptr;
  const char* const bad = curbline::bad_setting(setup.settings, curbline::board::limits);
  return bad != nullptr ? bad : "tilt.signal";
}

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
  using curbline::board::DriveEnd;
  const DriveEnd end = drive.run();
  if (!files.flush() || end == DriveEnd::no_room_for_results)
    return std::fprintf(stderr, "%s: cannot be written: %s\n", words[2], std::strerror(files.write_error)), 1;
  if (end == DriveEnd::done) return 0;
  if (end == DriveEnd::cut_record || end == DriveEnd::unknown_record) {
    std::fprintf(stderr, "%s: byte %zu: %s; expected ", words[1], files.bytes_read, to_string(end));
    if (end == DriveEnd::unknown_record) return std::fprintf(stderr, "one of curbline-drive-log\n"), 1;
    if (files.missing == 0) return std::fprintf(stderr, "one of its kind's length\n"), 1;
    return std::fprintf(stderr, "the rest of it, %zu more bytes\n", files.missing), 1;
  }
  const char* const bad = end == DriveEnd::setup_refused ? refused_setting(files.in.get()) : nullptr;
  if (bad == nullptr) return std::fprintf(stderr, "%s: %s\n", words[1], to_string(end)), 1;
  const char* const expected = "expected what lib/curbline/settings.hpp says of it, and the limits of this build";
  return std::fprintf(stderr, "%s: %s: %s; %s\n", words[1], to_string(end), bad, expected), 1;
}
