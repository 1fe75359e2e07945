#include "candump/candump.hpp"

#include <algorithm>
#include <charconv>

#include "text/part.hpp"

namespace curbline::candump {
namespace {

constexpr std::uint32_t error_flag = 0x20000000u;
constexpr std::size_t max_interface_name = 15;  // IFNAMSIZ - 1

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Value of a hexadecimal digit, -1 for another character.
int hex_value(char c) {
  if (is_digit(c)) return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

/// Removes the first blank-free word and the one blank after it from `text`; returns the word.
std::string_view take_word(std::string_view& text) {
  const std::size_t end = std::min(text.find(' '), text.size());
  const std::string_view word = port::part(text, 0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return word;
}

// The parsers below return an error, empty on success.

std::string_view parse_id(std::string_view digits, can::Frame& frame) {
  if (digits.size() != 3 && digits.size() != 8) return "bad id; expected 3 or 8 hexadecimal digits before #";
  std::uint32_t id = 0;
  for (const char c : digits) {
    if (hex_value(c) < 0) return "bad id; expected 3 or 8 hexadecimal digits before #";
    id = id << 4 | static_cast<std::uint32_t>(hex_value(c));
  }
  if (digits.size() == 3) {
    if (id > can::highest_id(false)) return "id out of range; expected at most 7FF in 3 digits";
  } else {
    frame.error = (id & error_flag) != 0;
    frame.extended = !frame.error;
    id &= ~error_flag;
    if (id > can::highest_id(true))
      return "id out of range; expected at most 1FFFFFFF, or 20000000 more for an error message";
  }
  frame.id = id;
  return {};
}

std::string_view parse_data(std::string_view digits, can::Frame& frame) {
  if (digits.size() % 2 != 0) return "odd number of data digits; expected two a byte";
  const std::size_t bytes = digits.size() / 2;
  if (!frame.fd && bytes > 8) return "too much data; expected at most 8 bytes";
  if (bytes > 64) return "too much data; expected at most 64 bytes";
  frame.length = static_cast<std::uint8_t>(bytes);
  if (can::fd_length(frame.length) != frame.length) return "no CAN FD length; expected 0-8, 12, 16, 20, 24, 32, 48, 64";
  for (std::size_t i = 0; i < bytes; ++i) {
    const int high = hex_value(digits[2 * i]), low = hex_value(digits[2 * i + 1]);
    if (high < 0 || low < 0) return "bad data; expected hexadecimal digits";
    frame.data[i] = static_cast<std::uint8_t>(high << 4 | low);
  }
  return {};
}

/// Parses what follows "R".
std::string_view parse_remote(std::string_view length, can::Frame& frame) {
  frame.remote = true;
  if (length.empty()) return {};
  if (length.size() > 1 || length[0] < '0' || length[0] > '8') return "bad remote length; expected R or R0 to R8";
  frame.length = static_cast<std::uint8_t>(length[0] - '0');
  return {};
}

/// Removes the length code, "_9" to "_F", that is appended to a classic frame of 8 bytes if its code on the bus is
/// above 8.
void cut_length_code(std::string_view& text) {
  if (text.size() < 2 || text[text.size() - 2] != '_' || hex_value(text.back()) <= 8) return;
  const std::string_view frame = port::part(text, 0, text.size() - 2);
  if (frame == "R8" || (frame.size() == 16 && frame[0] != '#')) text = frame;
}

std::string_view parse_frame(std::string_view text, can::Frame& frame) {
  const std::size_t hash = text.find('#');
  if (hash == std::string_view::npos) return "no frame; expected ID#DATA";
  if (const auto error = parse_id(port::part(text, 0, hash), frame); !error.empty()) return error;
  text.remove_prefix(hash + 1);
  cut_length_code(text);
  if (!text.empty() && text[0] == 'R') return parse_remote(port::part(text, 1), frame);
  if (!text.empty() && text[0] == '#') {
    if (text.size() < 2 || hex_value(text[1]) < 0) return "no CAN FD flags; expected one hexadecimal digit after ##";
    frame.fd = true;
    frame.fd_flags = static_cast<std::uint8_t>(hex_value(text[1]));
    text.remove_prefix(2);
  }
  return parse_data(text, frame);
}

/// Without -L, candump writes a format for the screen: "  can0  181   [6]  37 06", with -t preceded by a time.
bool is_for_the_screen(std::string_view line) {
  const std::size_t length = line.find('[');
  return length != std::string_view::npos && line.find('#') == std::string_view::npos && line.size() > length + 1 &&
         is_digit(line[length + 1]);
}

bool writable(const can::Frame& frame, std::string_view interface_name) {
  if (interface_name.empty() || interface_name.size() > max_interface_name) return false;
  if (interface_name.find(' ') != std::string_view::npos || frame.time_ns < 0) return false;
  return frame.fd_flags <= 15 && can::valid(frame);
}

/// Appends to a buffer that is known to be long enough.
class Writer {
 public:
  explicit Writer(std::span<char> line) : line_(line) {}
  void put(char c) { line_[size_++] = c; }
  void put(std::string_view text) {
    for (const char c : text) put(c);
  }
  void put_hex(std::uint32_t value, int digits) {
    for (int i = digits - 1; i >= 0; --i) put("0123456789ABCDEF"[value >> (4 * i) & 15u]);
  }
  void put_decimal(std::int64_t value, int digits) {
    char text[20];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    for (auto n = end - text; n < digits; ++n) put('0');
    put({text, static_cast<std::size_t>(end - text)});
  }
  std::size_t size() const { return size_; }

 private:
  std::span<char> line_;
  std::size_t size_ = 0;
};

}  // namespace

std::optional<std::int64_t> parse_time(std::string_view seconds) {
  constexpr std::int64_t second_ns = 1'000'000'000, latest_ns = INT64_MAX;
  const char* const last = seconds.data() + seconds.size();
  std::int64_t whole = 0;
  const auto [point, problem] = std::from_chars(seconds.data(), last, whole);
  if (problem != std::errc{} || !is_digit(seconds[0]) || whole > latest_ns / second_ns) return std::nullopt;
  std::int64_t fraction_ns = 0;
  if (point != last) {
    if (*point != '.' || point + 1 == last) return std::nullopt;
    std::int64_t unit_ns = 100'000'000;
    for (const char* digit = point + 1; digit != last; ++digit, unit_ns /= 10) {
      if (!is_digit(*digit)) return std::nullopt;
      fraction_ns += (*digit - '0') * unit_ns;
    }
  }
  if (whole == latest_ns / second_ns && fraction_ns > latest_ns % second_ns) return std::nullopt;
  return whole * second_ns + fraction_ns;
}

ParsedLine parse_line(std::string_view line) {
  ParsedLine parsed;
  const auto refuse = [](std::string_view error) { return ParsedLine{.error = error}; };
  line = port::part(line, 0, line.find_last_not_of(' ') + 1);
  if (is_for_the_screen(line)) return refuse("what candump writes for the screen; expected a log of candump -L");
  const std::string_view time = take_word(line);
  if (time.size() < 3 || time.front() != '(' || time.back() != ')')
    return refuse("no time; expected (SECONDS.DECIMALS)");
  const auto time_ns = parse_time(port::part(time, 1, time.size() - 2));
  if (!time_ns || time.find('.') == std::string_view::npos) return refuse("bad time; expected (SECONDS.DECIMALS)");
  parsed.frame.time_ns = *time_ns;
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  parsed.interface_name = take_word(line);
  if (parsed.interface_name.empty() || parsed.interface_name.size() > max_interface_name) {
    return refuse("bad interface name; expected 1 to 15 characters");
  }
  if (const auto error = parse_frame(take_word(line), parsed.frame); !error.empty()) return refuse(error);
  if (!line.empty() && line != "R" && line != "T") return refuse("text behind the frame; expected R, T or nothing");
  return parsed;
}

std::size_t format_line(const can::Frame& frame, std::string_view interface_name, std::span<char> line) {
  if (line.size() < max_line || !writable(frame, interface_name)) return 0;
  Writer out(line);
  out.put('(');
  out.put_decimal(frame.time_ns / 1'000'000'000, 1);
  out.put('.');
  out.put_decimal(frame.time_ns % 1'000'000'000 / 1'000, 6);
  out.put(") ");
  out.put(interface_name);
  out.put(' ');
  const bool long_id = frame.extended || frame.error;
  out.put_hex(frame.error ? frame.id | error_flag : frame.id, long_id ? 8 : 3);
  out.put('#');
  if (frame.remote) {
    out.put('R');
    if (frame.length > 0) out.put_decimal(frame.length, 1);
    return out.size();
  }
  if (frame.fd) {
    out.put('#');
    out.put_hex(frame.fd_flags, 1);
  }
  for (std::size_t i = 0; i < frame.length; ++i) out.put_hex(frame.data[i], 2);
  return out.size();
}

}  // namespace curbline::candump
