// Files and text on the host that runs the emulator or the debugger, for firmware that has none of its own. Every call
// stops the core until the host has answered, microseconds under QEMU and milliseconds through a probe: for tests and
// bring-up, not for a robot. Without a host a call faults. Not reentrant, not for interrupts. Nothing is allocated.
// Source: Arm, Semihosting for AArch32 and AArch64, release 2.0.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace curbline::semihosting {

/// Prints text to the host's console.
void print(const char* text);
/// Prints text, a decimal number and a line end.
void print_number(const char* text, std::uint32_t number);

/// Ends the emulator with this status (SYS_EXIT_EXTENDED).
[[noreturn]] void exit(int status);

/// The words of the program's command line given to the emulator, split at blanks. The first is the program's name.
class CommandLine {
 public:
  /// Requests it from the host. There are no words if there are more than 8, or more than 511 characters.
  CommandLine();
  std::span<const char* const> words() const { return {words_.data(), count_}; }

 private:
  static constexpr std::size_t max_words = 8;
  std::array<char, 512> text_{};
  std::array<const char*, max_words> words_{};
  std::size_t count_ = 0;
};

/// One file to read and one to write.
class FilePair {
 public:
  /// False if either cannot be opened. `out` is truncated.
  bool open(const char* in, const char* out);
  /// Fills the span and returns its length; less at the end of the file.
  std::size_t read(std::span<std::byte> bytes);
  bool write(std::span<const std::byte> bytes);

 private:
  int in_ = -1, out_ = -1;
};

}  // namespace curbline::semihosting
