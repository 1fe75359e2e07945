#include <algorithm>

#include "formats/dbc.hpp"
#include "formats/decimals.hpp"

namespace curbline::tools {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

void write_signal(std::ostream& out, const DbcSignal& s) {
  out << " SG_ " << s.name;
  if (s.is_multiplexor) out << " M";
  if (s.multiplexed) out << " m" << *s.multiplexed;
  out << " : " << s.start_bit << '|' << s.length << '@' << (s.order == can::ByteOrder::little ? '1' : '0')
      << (s.is_signed ? '-' : '+') << " (" << shortest(s.scale) << ',' << shortest(s.offset) << ") ["
      << shortest(s.minimum) << '|' << shortest(s.maximum) << "] " << quoted(s.unit) << " Vector__XXX\n";
}

/// The attributes that are stated, with their definitions.
void write_attributes(std::ostream& out, const Dbc& dbc) {
  for (const DbcAttribute& each : dbc_attributes) {
    const auto states = [&](const DbcMessage& message) { return message.attributes.contains(each.name); };
    if (std::ranges::none_of(dbc, states)) continue;
    out << "BA_DEF_ BO_ \"" << each.name << "\" INT " << each.lowest << ' ' << each.highest << ";\nBA_DEF_DEF_ \""
        << each.name << "\" " << each.otherwise << ";\n";
  }
  for (const DbcMessage& message : dbc) {
    for (const auto& [name, value] : message.attributes)
      out << "BA_ " << quoted(name) << " BO_ " << message.file_id() << ' ' << value << ";\n";
  }
}

}  // namespace

void write_dbc(std::ostream& out, const Dbc& dbc) {
  out << "VERSION \"\"\n\nNS_ :\n\nBS_:\n\nBU_:\n\n";
  for (const DbcMessage& message : dbc) {
    out << "BO_ " << message.file_id() << ' ' << message.name << ": " << message.length << " Vector__XXX\n";
    for (const DbcSignal& signal : message.signals) write_signal(out, signal);
    out << '\n';
  }
  for (const DbcMessage& message : dbc) {
    if (!message.comment.empty()) out << "CM_ BO_ " << message.file_id() << ' ' << quoted(message.comment) << ";\n";
    for (const DbcSignal& s : message.signals) {
      if (!s.comment.empty())
        out << "CM_ SG_ " << message.file_id() << ' ' << s.name << ' ' << quoted(s.comment) << ";\n";
    }
  }
  write_attributes(out, dbc);
  for (const DbcMessage& message : dbc) {
    for (const DbcSignal& s : message.signals) {
      if (s.type == DbcValueType::whole) continue;
      out << "SIG_VALTYPE_ " << message.file_id() << ' ' << s.name << " : " << (s.type == DbcValueType::float32 ? 1 : 2)
          << ";\n";
    }
  }
}

}  // namespace curbline::tools
