#include "robot/signal_dbc.hpp"

#include <algorithm>
#include <map>
#include <numbers>
#include <optional>

#include "curbline/can/curb_frames.hpp"
#include "formats/ascii.hpp"
#include "formats/decimals.hpp"

namespace curbline::tools {
namespace {

constexpr double pi = std::numbers::pi;

DbcSignal dbc_signal(const can::Signal& signal, const std::string& name, const std::string& unit) {
  DbcSignal out;
  out.name = name;
  out.start_bit = signal.start_bit;
  out.length = signal.length;
  out.order = signal.order;
  out.is_signed = signal.is_signed;
  out.type = signal.is_float ? DbcValueType::float32 : DbcValueType::whole;
  out.scale = signal.scale;
  out.offset = signal.offset;
  out.unit = unit;
  return out;
}

DbcSignal dbc_multiplexor(const can::Multiplexor& multiplexor) {
  DbcSignal out;
  out.name = "Multiplexor";
  out.start_bit = multiplexor.start_bit;
  out.length = multiplexor.length;
  out.order = multiplexor.order;
  out.is_multiplexor = true;
  return out;
}

/// Radians per unit of a DBC file, in the spellings that occur in files.
std::optional<double> radians_of(const std::string& unit) {
  static const std::map<std::string, double> known{{"rad", 1.0},       {"mrad", 1e-3},         {"deg", pi / 180},
                                                   {"Deg", pi / 180},  {"degree", pi / 180},   {"degrees", pi / 180},
                                                   {"\xB0", pi / 180}, {"\xC2\xB0", pi / 180}, {"rev", 2 * pi},
                                                   {"turn", 2 * pi},   {"turns", 2 * pi}};
  const auto found = known.find(unit);
  return found == known.end() ? std::nullopt : std::optional(found->second);
}

std::string order_line(can::ByteOrder order) {
  return std::string("byte_order = \"") + (order == can::ByteOrder::little ? "little" : "big") + "\"\n";
}

std::string flag(const char* key, bool value) {
  return std::string(key) + " = " + (value ? "true" : "false") + "\n";
}

}  // namespace

Dbc dbc_of(const Robot& robot) {
  const can::Signal& signal = robot.tilt_signal;
  DbcMessage message;
  message.name = "TiltServo";
  message.id = signal.id;
  message.extended = signal.extended;
  message.length = std::max<int>(can::bytes_needed(signal), signal.min_bytes);
  message.comment = "Angle of the tilt servo of " + printable_ascii(robot.name) + ".";
  const std::uint32_t all_bits = can::highest_id(signal.extended);
  if ((signal.id_mask & all_bits) != all_bits) {
    message.comment += " Any id that agrees with this one in the bits " + hexadecimal(signal.id_mask & all_bits) + ".";
    message.attributes[id_mask_attribute.name] = signal.id_mask;
  }
  const can::Signal plain;
  if (signal.min_bytes != plain.min_bytes) message.attributes[min_bytes_attribute.name] = signal.min_bytes;
  if (signal.max_bytes != plain.max_bytes) message.attributes[max_bytes_attribute.name] = signal.max_bytes;
  if (robot.tilt_sync_id) message.attributes[sync_id_attribute.name] = *robot.tilt_sync_id;
  if (signal.multiplexor) message.signals.push_back(dbc_multiplexor(*signal.multiplexor));
  message.signals.push_back(dbc_signal(signal, "Tilt", "rad"));
  if (signal.multiplexor) message.signals.back().multiplexed = signal.multiplexor->value;
  message.signals.back().comment = "Above 0 looks down.";
  Dbc dbc{message};
  if (robot.tilt_sync_id) {
    DbcMessage sync;
    sync.name = "Sync";
    sync.id = *robot.tilt_sync_id;
    sync.length = 0;
    sync.comment = "The servo samples its angle on this frame.";
    dbc.push_back(sync);
  }
  return dbc;
}

Dbc curb_dbc() {
  Dbc dbc;
  for (const can::CurbField& field : can::curb_fields()) {
    if (dbc.empty() || dbc.back().name != field.message) {
      DbcMessage message;
      message.name = field.message;
      message.id = field.signal.id;
      message.length = 0;
      dbc.push_back(message);
    }
    DbcMessage& message = dbc.back();
    message.length = std::max(message.length, can::bytes_needed(field.signal));
    message.signals.push_back(dbc_signal(field.signal, field.name, field.unit));
    message.signals.back().comment = field.meaning;
    message.signals.back().minimum = field.minimum;
    message.signals.back().maximum = field.maximum;
  }
  return dbc;
}

std::string tilt_toml(const DbcTiltSignal& found, const std::string& source) {
  can::Signal signal = found.signal;
  const auto radians = radians_of(found.unit);
  std::string text = "# " + printable_ascii(source) + ", unit \"" + printable_ascii(found.unit) + "\"\n";
  if (!radians) text += "# Not known as an angle: multiply scale and offset by the radians of one unit.\n";
  signal.scale *= radians.value_or(1.0);
  signal.offset *= radians.value_or(1.0);
  text += "[tilt.signal]\nid = " + hexadecimal(signal.id) + "\n";
  const can::Signal plain;
  if (signal.id_mask != plain.id_mask) text += "id_mask = " + hexadecimal(signal.id_mask) + "\n";
  text += flag("extended", signal.extended) + "start_bit = " + shortest(signal.start_bit) +
          "\nlength = " + shortest(+signal.length) + "\n" + order_line(signal.order) +
          flag("signed", signal.is_signed) + flag("float", signal.is_float) + "scale = " + shortest(signal.scale) +
          "\noffset = " + shortest(signal.offset) + "\n";
  if (signal.min_bytes != plain.min_bytes) text += "min_bytes = " + shortest(+signal.min_bytes) + "\n";
  if (signal.max_bytes != plain.max_bytes) text += "max_bytes = " + shortest(+signal.max_bytes) + "\n";
  if (found.sync_id) text += "sync_id = " + hexadecimal(*found.sync_id) + "\n";
  if (!signal.multiplexor) return text;
  const can::Multiplexor& m = *signal.multiplexor;
  return text + "\n[tilt.signal.multiplexor]\nstart_bit = " + shortest(m.start_bit) +
         "\nlength = " + shortest(+m.length) + "\n" + order_line(m.order) + "value = " + shortest(m.value) + "\n";
}

}  // namespace curbline::tools
