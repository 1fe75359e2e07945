#include "lms200/telegram.hpp"

#include <algorithm>

namespace curbline::lms200 {

std::size_t frame(std::uint8_t address, std::span<const std::uint8_t> content, std::span<std::uint8_t> telegram) {
  const std::size_t size = header_bytes + content.size();
  telegram[0] = stx;
  telegram[1] = address;
  telegram[2] = static_cast<std::uint8_t>(content.size());
  telegram[3] = static_cast<std::uint8_t>(content.size() >> 8);
  std::copy(content.begin(), content.end(), telegram.begin() + header_bytes);
  const std::uint16_t crc = crc_of(telegram.first(size));
  telegram[size] = static_cast<std::uint8_t>(crc);
  telegram[size + 1] = static_cast<std::uint8_t>(crc >> 8);
  return size + crc_bytes;
}

}  // namespace curbline::lms200
