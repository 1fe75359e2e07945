#include "semihosting/semihosting.hpp"

#include <cstring>

namespace curbline::semihosting {
namespace {

enum class Operation : std::uint32_t {
  open = 0x01,
  write0 = 0x04,
  write = 0x05,
  read = 0x06,
  get_command_line = 0x15,
  exit_extended = 0x20
};
enum class OpenMode : std::uint32_t { read_binary = 1, write_binary = 5 };
using Word = std::uint32_t;

/// Arguments are words in memory; only write0 takes the address of its text.
int call(Operation operation, const void* arguments) {
  register Word r0 asm("r0") = static_cast<Word>(operation);
  register const void* r1 asm("r1") = arguments;
#if defined(__ARM_ARCH_PROFILE) && __ARM_ARCH_PROFILE == 'M'
  asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
#else
  asm volatile("svc 0xAB" : "+r"(r0) : "r"(r1) : "memory", "lr");  // Thumb state; lr for programs in supervisor mode
#endif
  return static_cast<int>(r0);
}

Word address(const void* p) {
  return static_cast<Word>(reinterpret_cast<std::uintptr_t>(p));
}

int open_file(const char* name, OpenMode mode) {
  const std::array<Word, 3> arguments{address(name), static_cast<Word>(mode), static_cast<Word>(std::strlen(name))};
  return call(Operation::open, arguments.data());
}

}  // namespace

void print(const char* text) {
  call(Operation::write0, text);
}

void print_number(const char* text, std::uint32_t number) {
  std::array<char, 12> digits{};
  char* p = digits.data() + digits.size() - 1;
  *--p = '\n';
  do {
    *--p = static_cast<char>('0' + number % 10);
    number /= 10;
  } while (number > 0);
  print(text);
  print(p);
}

void exit(int status) {
  constexpr Word application_exit = 0x20026;
  const std::array<Word, 2> arguments{application_exit, static_cast<Word>(status)};
  while (true) call(Operation::exit_extended, arguments.data());
}

CommandLine::CommandLine() {
  std::array<Word, 2> arguments{address(text_.data()), static_cast<Word>(text_.size())};
  if (call(Operation::get_command_line, arguments.data()) != 0) return;
  bool in_word = false;
  for (char& c : text_) {
    if (c == '\0') return;
    if (c == ' ') {
      c = '\0';
      in_word = false;
    } else if (!in_word) {
      in_word = true;
      if (count_ == max_words) {
        count_ = 0;
        return;
      }
      words_[count_++] = &c;
    }
  }
}

bool FilePair::open(const char* in, const char* out) {
  in_ = open_file(in, OpenMode::read_binary);
  out_ = open_file(out, OpenMode::write_binary);
  return in_ >= 0 && out_ >= 0;
}

std::size_t FilePair::read(std::span<std::byte> bytes) {
  const std::array<Word, 3> arguments{static_cast<Word>(in_), address(bytes.data()), static_cast<Word>(bytes.size())};
  const int missing = call(Operation::read, arguments.data());
  return missing < 0 || static_cast<std::size_t>(missing) > bytes.size()
             ? 0
             : bytes.size() - static_cast<std::size_t>(missing);
}

bool FilePair::write(std::span<const std::byte> bytes) {
  const std::array<Word, 3> arguments{static_cast<Word>(out_), address(bytes.data()), static_cast<Word>(bytes.size())};
  return call(Operation::write, arguments.data()) == 0;
}

}  // namespace curbline::semihosting
