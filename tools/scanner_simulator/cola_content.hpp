// Builds the telegrams of a CoLa B scanner from letters and numbers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "cola/telegram.hpp"
#include "scanner_simulator/device.hpp"

namespace curbline::tools {

class ColaContent {
 public:
  explicit ColaContent(std::string_view command) { bytes_.assign(command.begin(), command.end()); }
  /// Big endian; `size` in bytes, 8 at most.
  ColaContent& number(std::uint64_t value, int size) {
    for (int i = size - 1; i >= 0; --i) bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    return *this;
  }
  ColaContent& text(std::string_view letters) {
    bytes_.insert(bytes_.end(), letters.begin(), letters.end());
    return *this;
  }
  Bytes telegram() const {
    Bytes telegram(cola::Format::header + bytes_.size() + 1);
    std::copy(bytes_.begin(), bytes_.end(), telegram.begin() + cola::Format::header);
    cola::frame(telegram, bytes_.size());
    return telegram;
  }

 private:
  Bytes bytes_;
};

}  // namespace curbline::tools
