#include "scip2/decoder.hpp"

#include <algorithm>

#include "scip2/codec.hpp"
#include "text/part.hpp"

namespace curbline::scip2 {
namespace {

constexpr std::size_t scan_echo_size = 15;  // MD, two steps of 4, cluster 2, interval 1, number of scans 2

bool all_digits(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool is_scan_echo(std::string_view line) {
  return line.size() >= scan_echo_size && line[0] == 'M' && (line[1] == 'D' || line[1] == 'S') &&
         all_digits(port::part(line, 2, scan_echo_size - 2));
}

/// Whether all characters belong to the code. Flipping one of a character's two highest bits does not change the
/// checksum, but takes the character out of the code.
bool all_encoded(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= 'o'; });
}

bool is_status(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z'); });
}

/// "DMIN:23;7": the semicolon before a checksum may be excluded from it.
bool body_sum_is_right(std::string_view line) {
  const bool has_semicolon = line.size() >= 3 && line[line.size() - 2] == ';';
  return sum_is_right(line) || (has_semicolon && sum_of(port::part(line, 0, line.size() - 2)) == line.back());
}

int number(std::string_view digits) {
  int value = 0;
  for (const char c : digits) value = 10 * value + (c - '0');
  return value;
}

}  // namespace

void Decoder::restart() {
  state_ = State::echo;
  line_size_ = 0;
  too_long_ = false;
}

Decoder::Event Decoder::take(std::span<const std::uint8_t>& bytes) {
  while (!bytes.empty()) {
    const char c = static_cast<char>(bytes.front());
    bytes = bytes.subspan(1);
    if (c != '\n') {
      if (line_size_ < line_.size()) {
        line_[line_size_++] = c;
      } else {
        too_long_ = true;
      }
      continue;
    }
    std::string_view line(line_.data(), line_size_);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);  // commands may end in CR LF, and so their echoes
    Event event = Event::none;
    if (too_long_) {
      drop(counters_.wrong_length, line);
    } else {
      event = take_line(line);
    }
    line_size_ = 0;
    too_long_ = false;
    if (event != Event::none) return event;
  }
  return Event::none;
}

Decoder::Event Decoder::take_line(std::string_view line) {
  if (line.empty()) return end_reply();
  switch (state_) {
    case State::echo:  // may follow the start of another echo that was truncated
      if (begin_scan_echo(line)) {
        counters_.cut += echo_size_ < line.size();
      } else {
        take_echo(line);
      }
      break;
    case State::status:
      take_status(line);
      break;
    case State::skip:
      counters_.bytes_skipped += line.size() + 1;
      begin_scan_echo(line);
      break;
    case State::stamp:
    case State::ranges:
      if (sum_is_right(line) && all_encoded(line)) {
        take_ranges(port::part(line, 0, line.size() - 1));
      } else {
        drop(counters_.bad_checksum, line);
      }
      break;
    case State::body:
      if (body_sum_is_right(line)) {
        take_body(port::part(line, 0, line.size() - 1));
      } else {
        drop(counters_.bad_checksum, line);
      }
      break;
  }
  return Event::none;
}

void Decoder::take_echo(std::string_view line) {
  if (line.size() > echo_.size()) {
    drop(counters_.wrong_length, line);
    return;
  }
  std::copy(line.begin(), line.end(), echo_.begin());
  echo_size_ = line.size();
  text_size_ = 0;
  state_ = State::status;
}

void Decoder::take_status(std::string_view line) {
  if (line.size() != 3) {
    drop(counters_.wrong_length, line);
  } else if (!sum_is_right(line) || !is_status(port::part(line, 0, 2))) {
    drop(counters_.bad_checksum, line);
  } else {
    std::copy_n(line.begin(), status_.size(), status_.begin());
    const bool scan = is_scan_echo(echo()) && port::part(line, 0, 2) == "99";
    state_ = scan ? State::stamp : State::body;
  }
}

/// First the line of the stamp, then those of the ranges.
void Decoder::take_ranges(std::string_view characters) {
  if (state_ == State::stamp) {
    if (characters.size() != 4) return drop(counters_.wrong_length, {});
    scan_.stamp_ms = decode(characters);
    state_ = State::ranges;
  } else if (characters.size() > 64 || text_size_ + characters.size() > text_.size()) {
    drop(counters_.wrong_length, {});
  } else {
    std::copy(characters.begin(), characters.end(), text_.begin() + static_cast<std::ptrdiff_t>(text_size_));
    text_size_ += characters.size();
  }
}

void Decoder::take_body(std::string_view line) {
  if (text_size_ + line.size() + 1 > text_.size()) return drop(counters_.wrong_length, {});
  std::copy(line.begin(), line.end(), text_.begin() + static_cast<std::ptrdiff_t>(text_size_));
  text_size_ += line.size();
  text_[text_size_++] = '\n';
}

/// Drops the reply up to the empty line that ends it. If it was truncated, the damaged line may end in the echo of the
/// next scan.
void Decoder::drop(std::uint64_t& counter, std::string_view line) {
  ++counter;
  counters_.bytes_skipped += line.size() + 1;
  state_ = State::skip;
  if (begin_scan_echo(line)) ++counters_.cut;
}

bool Decoder::begin_scan_echo(std::string_view line) {
  if (line.size() < scan_echo_size) return false;
  const std::string_view end = port::part(line, line.size() - scan_echo_size);
  if (!is_scan_echo(end)) return false;
  take_echo(end);
  return true;
}

Decoder::Event Decoder::end_reply() {
  const State state = state_;
  state_ = State::echo;
  switch (state) {
    case State::ranges:
      return end_scan();
    case State::body:
      reply_ = {echo(), {status_.data(), status_.size()}, {text_.data(), text_size_}};
      return Event::reply;
    case State::status:
    case State::stamp:
      ++counters_.wrong_length;
      return Event::none;
    case State::echo:  // an empty line between replies
    case State::skip:
      return Event::none;
  }
  return Event::none;
}

Decoder::Event Decoder::end_scan() {
  scan_.first_step = number(port::part(echo(), 2, 4));
  scan_.last_step = number(port::part(echo(), 6, 4));
  const int cluster = std::max(1, number(port::part(echo(), 10, 2)));
  const std::size_t width = echo_[1] == 'D' ? 3 : 2;
  if (cluster != 1) {
    ++counters_.unsupported;
    return Event::none;
  }
  const int steps = scan_.last_step - scan_.first_step + 1;
  if (steps < 1 || steps > most_steps || text_size_ != width * static_cast<std::size_t>(steps)) {
    ++counters_.wrong_length;
    return Event::none;
  }
  const std::string_view text(text_.data(), text_size_);
  for (std::size_t i = 0; i < static_cast<std::size_t>(steps); ++i)
    ranges_mm_[i] = decode(port::part(text, width * i, width));
  scan_.ranges_mm = std::span(ranges_mm_).first(static_cast<std::size_t>(steps));
  return Event::scan;
}

}  // namespace curbline::scip2
