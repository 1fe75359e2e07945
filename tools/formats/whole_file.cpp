#include "formats/whole_file.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "formats/bad_input.hpp"

namespace curbline::tools {

std::string read_whole(const std::string& path, std::size_t most_mib, const std::string& expected) {
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  errno = 0;
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rb"));
  std::string text;
  std::array<char, 65536> part{};
  while (file && text.size() <= most_mib << 20) {
    const std::size_t got = std::fread(part.data(), 1, part.size(), file.get());
    if (got == 0) break;
    text.append(part.data(), got);
  }
  if (!file || std::ferror(file.get()) != 0)
    throw BadInput(path + ": cannot be read: " + std::strerror(errno) + "; expected " + expected);
  if (text.size() > most_mib << 20)
    throw BadInput(path + ": longer than " + std::to_string(most_mib) + " MiB; expected " + expected);
  return text;
}

}  // namespace curbline::tools
