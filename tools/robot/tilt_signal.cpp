#include "robot/parts.hpp"

#include "curbline/can/servo_presets.hpp"
#include "curbline/can/tilt_decoder.hpp"

namespace curbline::tools {
namespace {

constexpr double furthest_rad = 1e6;

/// The preset of a servo, with the keys that only presets have.
can::Signal read_servo(TomlTable& table) {
  std::string servo = "cia402";
  table.read("servo", servo);
  const auto node = [&](int lowest, int highest) {
    std::uint8_t number = 1;
    table.read_whole("node", number, lowest, highest);
    return number;
  };
  if (servo == "cia402") return can::cia402_position(node(1, 127));
  if (servo == "odrive") return can::odrive_encoder_estimates(node(0, 63));
  if (servo == "vesc") return can::vesc_status_4(node(0, 255));
  if (servo == "cubemars") return can::cubemars_servo(node(0, 255));
  if (servo == "robstride") return can::robstride_feedback(node(0, 255));
  if (servo == "mini-cheetah") {
    double p_max_rad = 12.5;
    table.read("p_max_rad", p_max_rad, {0.1, 1000.0});
    return can::mini_cheetah_reply(0, p_max_rad);  // the master's id by default
  }
  table.refuse_word("servo", servo, "cia402, odrive, vesc, cubemars, robstride or mini-cheetah");
}

can::ByteOrder read_byte_order(TomlTable& table, can::ByteOrder otherwise) {
  std::string word = otherwise == can::ByteOrder::little ? "little" : "big";
  table.read("byte_order", word);
  if (word != "little" && word != "big") table.refuse_word("byte_order", word, "little or big");
  return word == "little" ? can::ByteOrder::little : can::ByteOrder::big;
}

void read_multiplexor(TomlTable& signal_table, can::Signal& signal) {
  if (!signal_table.has("multiplexor")) return;
  TomlTable table = signal_table.table("multiplexor");
  can::Multiplexor multiplexor{.order = signal.order};
  table.read_whole("start_bit", multiplexor.start_bit, 0, 511);
  table.read_whole("length", multiplexor.length, 1, 63);
  multiplexor.order = read_byte_order(table, multiplexor.order);
  table.read_whole("value", multiplexor.value, 0, (std::int64_t{1} << multiplexor.length) - 1);
  table.done();
  signal.multiplexor = multiplexor;
  if (can::Signal alone{.start_bit = multiplexor.start_bit, .length = multiplexor.length, .order = multiplexor.order};
      !can::valid(alone)) {
    table.refuse("start_bit", "does not fit; expected bits within the 64 bytes of a frame");
  }
}

std::optional<std::uint16_t> read_sync_id(TomlTable& table, const can::Signal& signal) {
  if (!table.has("sync_id")) return std::nullopt;
  std::uint16_t id = can::default_sync_id;
  table.read_whole("sync_id", id, 0, 0x7FF);
  if (!can::TiltDecoder().init(signal, id))
    table.refuse("sync_id", "is the signal's own; expected that of the SYNC frame");
  return id;
}

void check_signal(const TomlTable& table, const can::Signal& signal) {
  if (signal.scale == 0.0) table.refuse("scale", "is 0; expected radians a count");
  if (signal.is_float && signal.length != 32) table.refuse("length", "does not fit; expected 32 for a float");
  if (signal.id > can::highest_id(signal.extended)) {
    table.refuse("id", "is too large; expected 11 bits (0x7FF), or 29 and extended = true");
  }
  can::Signal anywhere = signal;
  anywhere.max_bytes = 64;
  if (can::valid(anywhere) && !can::valid(signal)) {
    table.refuse("max_bytes", "is " + std::to_string(signal.max_bytes) + "; expected " +
                                  std::to_string(can::bytes_needed(signal)) + " or more, which the signal needs");
  }
  if (!can::valid(signal)) table.refuse("start_bit", "does not fit; expected bits within the 64 bytes of a frame");
}

}  // namespace

void read_tilt_signal(TomlTable table, Robot& robot) {
  can::Signal signal = read_servo(table);
  table.read_whole("id", signal.id, 0, 0x1FFFFFFF);
  table.read_whole("id_mask", signal.id_mask, 0, 0x1FFFFFFF);
  table.read("extended", signal.extended);
  table.read_whole("start_bit", signal.start_bit, 0, 511);
  table.read_whole("length", signal.length, 1, 64);
  signal.order = read_byte_order(table, signal.order);
  table.read("signed", signal.is_signed);
  table.read("float", signal.is_float);
  table.read("scale", signal.scale, {-furthest_rad, furthest_rad});
  table.read("offset", signal.offset, {-furthest_rad, furthest_rad});
  table.read_whole("min_bytes", signal.min_bytes, 0, 64);
  table.read_whole("max_bytes", signal.max_bytes, 1, 64);
  read_multiplexor(table, signal);
  check_signal(table, signal);
  robot.tilt_sync_id = read_sync_id(table, signal);
  table.done();
  robot.tilt_signal = signal;
}

}  // namespace curbline::tools
