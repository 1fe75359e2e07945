// Arbitrary frames, as a driver has them too, signals and lines of a candump log.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "candump/candump.hpp"
#include "curbline/can/curb_frames.hpp"
#include "curbline/can/signal.hpp"
#include "curbline/can/tilt_decoder.hpp"
#include "fuzz/claim.hpp"
#include "fuzz/run.hpp"
#include "socketcan/raw_frame.hpp"
#include "xilinx_can/registers.hpp"

namespace curbline::fuzz {
namespace {

can::Frame some_frame(Numbers& numbers) {
  can::Frame frame;
  frame.time_ns = numbers.time_ns();
  frame.id = numbers.bits32();
  frame.extended = numbers.flag();
  frame.remote = numbers.seldom();
  frame.error = numbers.seldom();
  frame.fd = numbers.seldom();
  frame.fd_flags = static_cast<std::uint8_t>(numbers.whole(0, 255));
  frame.length = static_cast<std::uint8_t>(numbers.whole(0, numbers.seldom() ? 255 : 64));
  for (std::uint8_t& byte : frame.data) byte = static_cast<std::uint8_t>(numbers.whole(0, 255));
  return frame;
}

can::Signal some_signal(Numbers& numbers) {
  const auto byte = [&](int most) { return static_cast<std::uint8_t>(numbers.whole(0, most)); };
  const auto order = [&] { return numbers.flag() ? can::ByteOrder::big : can::ByteOrder::little; };
  can::Signal s;
  s.id = numbers.bits32() & (numbers.flag() ? 0x7FF : 0xFFFFFFFF);
  s.extended = numbers.flag();
  if (numbers.flag()) s.id_mask = numbers.bits32();
  s.start_bit = static_cast<std::uint16_t>(numbers.whole(0, numbers.seldom() ? 65535 : 511));
  s.length = byte(numbers.seldom() ? 255 : 64);
  s.order = order();
  s.is_signed = numbers.flag();
  s.is_float = numbers.seldom();
  s.scale = static_cast<double>(numbers.rarely_any(0.001f));
  s.offset = static_cast<double>(numbers.rarely_any(0.0f));
  if (numbers.flag())
    s.multiplexor = can::Multiplexor{static_cast<std::uint16_t>(numbers.whole(0, 511)), byte(64), order(), byte(255)};
  s.min_bytes = byte(64);
  s.max_bytes = byte(255);
  return s;
}

void signals(Numbers& numbers) {
  const can::Signal signal = some_signal(numbers);
  const auto sync_id =
      numbers.flag() ? std::optional(static_cast<std::uint16_t>(numbers.whole(0, 65535))) : std::nullopt;
  can::TiltDecoder decoder;
  const bool ready = decoder.init(signal, sync_id);
  claim(can::valid(signal) || !ready, "a decoder takes no signal that is not valid");
  while (!numbers.used_up()) {
    can::Frame frame = some_frame(numbers);
    if (numbers.flag()) frame.id = signal.id, frame.extended = signal.extended;
    const std::optional<TiltReading> reading = decoder.take(frame);
    claim(!reading || (ready && std::abs(reading->angle_rad) <= TiltReading::furthest_rad),
          "a reading is an angle of a servo");
    const can::TiltDecoderCounters c = decoder.counters();
    claim(c.frames == c.readings + c.others + c.syncs + c.malformed + c.without_sync, "every frame is counted once");
    std::optional<CurbAhead> curb;
    can::CurbStatus status;
    can::read_curb_ahead(frame, curb);
    can::read_curb_status(frame, status);
    if (!can::valid(signal)) continue;
    const double value = static_cast<double>(numbers.rarely_any(1.0f));
    frame.length = std::min(frame.length, signal.max_bytes);
    can::encode(signal, value, frame);
    const std::optional<double> back = can::decode(signal, frame);
    if (signal.multiplexor) continue;  // its bits may overlap those of the value
    claim(can::carries(signal, frame), "a frame that a value was written into bears it");
    claim(back || signal.is_float || !std::isfinite(value), "and gives it back, if it is finite");
  }
}

void log_lines(Numbers& numbers) {
  const can::Frame frame = some_frame(numbers);
  std::array<char, candump::max_line> text;
  if (const std::size_t size = candump::format_line(frame, "can0", text)) {
    const candump::ParsedLine back = candump::parse_line({text.data(), size});
    claim(back.ok() && back.interface_name == "can0", "a line that was written is read");
    claim(back.frame.id == frame.id && back.frame.length == frame.length && back.frame.remote == frame.remote &&
              back.frame.error == frame.error && back.frame.fd == frame.fd &&
              (frame.error || back.frame.extended == frame.extended),
          "as the frame it was");
    for (std::size_t i = 0; i < frame.length && !frame.remote; ++i)
      claim(back.frame.data[i] == frame.data[i], "with its bytes");
  }
  const std::string line = numbers.text();
  const candump::ParsedLine parsed = candump::parse_line(line);
  if (!parsed.ok()) return;
  claim(parsed.frame.length <= 64 && !parsed.interface_name.empty(), "what is read is a frame");
  claim(candump::format_line(parsed.frame, parsed.interface_name, text) > 0 || parsed.interface_name.size() > 15,
        "and can be written");
}

bool same(const can::Frame& a, const can::Frame& b) {
  return a.id == b.id && a.extended == b.extended && a.remote == b.remote && a.length == b.length && a.data == b.data;
}

/// What the kernel and a controller may give.
void driver_frames(Numbers& numbers) {
  while (!numbers.used_up()) {
    canfd_frame raw{};
    raw.can_id = numbers.bits32();
    raw.len = numbers.byte();
    raw.flags = numbers.byte();
    for (std::uint8_t& byte : raw.data) byte = numbers.byte();
    const bool fd = numbers.flag();
    const can::Frame frame = socketcan::to_frame(raw, fd, 0);
    claim(frame.id <= can::highest_id(frame.extended) && frame.length <= (fd ? 64 : 8),
          "a frame of the kernel has an id and a length");
    if (can::valid(frame))
      claim(same(socketcan::to_frame(socketcan::from_frame(frame), fd, 0), frame), "and is sent as it was");
    const can::Frame of_controller =
        xilinx_can::frame_of({numbers.bits32(), numbers.bits32(), numbers.bits32(), numbers.bits32()}, 0);
    claim(can::valid(of_controller), "a controller's frame is one of a bus");
    const std::uint32_t id = xilinx_can::id_word(of_controller.id, of_controller.extended, of_controller.remote);
    const std::uint32_t length = static_cast<std::uint32_t>(of_controller.length) << 28;
    const std::array words{id, length, xilinx_can::data_word(of_controller, 0),
                           xilinx_can::data_word(of_controller, 4)};
    claim(same(xilinx_can::frame_of(words, 0), of_controller), "and is sent as it was");
  }
}

}  // namespace

void run(Numbers& numbers) {
  switch (numbers.whole(0, 3)) {
    case 0:
      return log_lines(numbers);
    case 1:
      return driver_frames(numbers);
    default:
      return signals(numbers);
  }
}

}  // namespace curbline::fuzz
