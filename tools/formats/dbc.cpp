#include "formats/dbc.hpp"

#include <algorithm>
#include <set>
#include <string_view>

#include "formats/bad_input.hpp"
#include "formats/dbc_scanner.hpp"
#include "formats/line_reader.hpp"
#include "formats/parse_number.hpp"
#include "formats/whole_file.hpp"

namespace curbline::tools {
namespace {

constexpr std::uint64_t most = 0xFFFFFFFF;
constexpr std::uint32_t no_message = 0xC0000000;  // contains the signals that belong to no message

/// Statements that end with a semicolon and do not affect a signal's bits.
const std::set<std::string_view> passed_over{"VAL_TABLE_",     "BO_TX_BU_",       "EV_",
                                             "ENVVAR_DATA_",   "EV_DATA_",        "CM_",
                                             "BA_DEF_",        "BA_DEF_REL_",     "BA_",
                                             "BA_REL_",        "BA_DEF_DEF_",     "VAL_",
                                             "SIG_GROUP_",     "BA_SGTYPE_",      "SGTYPE_",
                                             "SGTYPE_VAL_",    "SIG_TYPE_REF_",   "CAT_DEF_",
                                             "CAT_",           "FILTER",          "BA_DEF_DEF_REL_",
                                             "BA_DEF_SGTYPE_", "SIGTYPE_VALTYPE_"};
const std::set<std::string_view> taken{"VERSION", "NS_", "BS_", "BU_", "BO_", "SG_", "SIG_VALTYPE_", "SG_MUL_VAL_"};

bool begins_a_statement(std::string_view word) {
  return passed_over.contains(word) || taken.contains(word);
}

std::string read_text(const std::string& path) {
  std::string text = read_whole(path, 16, "a DBC file");
  if (text.starts_with(byte_order_mark)) text.erase(0, byte_order_mark.size());
  return text;
}

class DbcParser {
 public:
  explicit DbcParser(const std::string& path) : in_(path, read_text(path)) {}
  Dbc parse();

 private:
  void statement(const std::string& keyword);
  void symbols();
  void nodes();
  void message();
  void signal();
  void multiplexing(DbcSignal& signal);
  void receivers();
  void value_type();
  void ranges();
  void attribute();
  DbcSignal* named_signal();

  DbcScanner in_;
  Dbc dbc_;
  DbcMessage orphans_;             ///< signals without a message
  DbcMessage* current_ = nullptr;  ///< the message whose signals follow
  std::set<std::string> names_;    ///< names of messages
  std::set<std::uint32_t> ids_;
};

Dbc DbcParser::parse() {
  if (in_.at_end()) in_.fail("the file is empty; expected DBC");
  while (!in_.at_end()) statement(in_.word("a DBC statement"));
  return std::move(dbc_);
}

void DbcParser::statement(const std::string& keyword) {
  if (keyword == "SG_") return signal();
  current_ = nullptr;
  if (keyword == "BO_") return message();
  if (keyword == "VERSION") return static_cast<void>(in_.string("the version"));
  if (keyword == "NS_") return symbols();
  if (keyword == "BS_" || keyword == "BU_") return nodes();
  if (keyword == "SIG_VALTYPE_") return value_type();
  if (keyword == "SG_MUL_VAL_") return ranges();
  if (keyword == "BA_") return attribute();
  if (passed_over.contains(keyword)) return in_.skip_statement();
  in_.fail("unknown statement " + keyword.substr(0, 40) + "; expected BO_, SG_ or another of DBC");
}

/// The keywords that a file may use, up to the baud rate statement that follows in every file.
void DbcParser::symbols() {
  in_.expect(':');
  const std::set<std::string_view> none_of_them{"", "BS_", "BU_", "BO_"};
  while (!none_of_them.contains(in_.peek_word())) in_.word("a symbol");
}

/// Nodes, or a baud rate and its timing.
void DbcParser::nodes() {
  in_.expect(':');
  if (in_.peek_word().empty() && !in_.at_end()) {
    in_.whole("the baud rate", most);
    for (const char mark : {':', ','}) {
      if (in_.take(mark)) in_.whole("the bus timing", most);
    }
  }
  while (!in_.peek_word().empty() && !begins_a_statement(in_.peek_word())) in_.word("a node");
}

void DbcParser::message() {
  in_.at_end();
  DbcMessage message;
  message.line = in_.line();
  const auto id = static_cast<std::uint32_t>(in_.whole("a message's id", most));
  message.extended = (id & DbcMessage::extended_bit) != 0;
  message.id = id & ~DbcMessage::extended_bit;
  if (id != no_message && message.id > can::highest_id(message.extended)) {
    in_.fail("id " + std::to_string(id) + " is none of CAN; expected 11 bits, or 29 and bit 31");
  }
  message.name = in_.word("a message's name");
  in_.expect(':');
  message.length = static_cast<int>(in_.whole("a message's length", 65535));
  in_.word("a sender");
  if (id == no_message) {
    orphans_.signals.clear();
    current_ = &orphans_;
    return;
  }
  if (!ids_.insert(id).second)
    in_.fail_at(message.line, "id " + std::to_string(id) + " comes twice; expected one message of each id");
  if (!names_.insert(message.name).second) {
    in_.fail_at(message.line, "message " + message.name + " comes twice; expected one of each name");
  }
  dbc_.push_back(std::move(message));
  current_ = &dbc_.back();
}

void DbcParser::multiplexing(DbcSignal& signal) {
  if (in_.take(':')) return;
  const std::string word = in_.word("':', M or m and a number");
  const bool both = word.size() > 2 && word.ends_with("M");
  signal.is_multiplexor = word == "M" || both;
  if (word != "M") {
    const std::string digits = word.substr(1, word.size() - 1 - (both ? 1 : 0));
    signal.multiplexed = parse_number<std::uint64_t>(digits);
    if (word[0] != 'm' || !signal.multiplexed) in_.fail(word.substr(0, 40) + "; expected ':', M or m and a number");
  }
  in_.expect(':');
}

void DbcParser::signal() {
  in_.at_end();
  if (current_ == nullptr) in_.fail("a signal outside a message; expected BO_ before SG_");
  DbcSignal signal;
  signal.line = in_.line();
  signal.name = in_.word("a signal's name");
  multiplexing(signal);
  signal.start_bit = static_cast<std::uint16_t>(in_.whole("a start bit", 65535));
  in_.expect('|');
  signal.length = static_cast<std::uint16_t>(in_.whole("a length", 65535));
  in_.expect('@');
  signal.order = in_.whole("the byte order", 1) == 1 ? can::ByteOrder::little : can::ByteOrder::big;
  signal.is_signed = in_.take('-');
  if (!signal.is_signed) in_.expect('+');
  in_.expect('(');
  signal.scale = in_.number("the factor");
  in_.expect(',');
  signal.offset = in_.number("the offset");
  in_.expect(')');
  in_.expect('[');
  signal.minimum = in_.number("the minimum");
  in_.expect('|');
  signal.maximum = in_.number("the maximum");
  in_.expect(']');
  signal.unit = in_.string("the unit");
  receivers();
  const auto same = [&](const DbcSignal& other) { return other.name == signal.name; };
  if (current_ != &orphans_ && std::any_of(current_->signals.begin(), current_->signals.end(), same)) {
    in_.fail_at(signal.line, "signal " + signal.name + " comes twice; expected one of each name in a message");
  }
  current_->signals.push_back(std::move(signal));
}

/// Nodes, separated by commas.
void DbcParser::receivers() {
  while (!in_.peek_word().empty() && !begins_a_statement(in_.peek_word())) {
    in_.word("a receiver");
    in_.take(',');
  }
}

/// The signal that a statement names by its message's id and its own name; null for one without a message.
DbcSignal* DbcParser::named_signal() {
  const auto id = static_cast<std::uint32_t>(in_.whole("a message's id", most));
  const std::string name = in_.word("a signal's name");
  if (id == no_message) return nullptr;
  for (DbcMessage& message : dbc_) {
    if (message.file_id() != id) continue;
    for (DbcSignal& signal : message.signals) {
      if (signal.name == name) return &signal;
    }
  }
  in_.fail("no signal " + name + " in a message of id " + std::to_string(id) + "; expected one that SG_ describes");
}

void DbcParser::value_type() {
  DbcSignal* const signal = named_signal();
  in_.take(':');
  const std::uint64_t type = in_.whole("the value type", 3);
  in_.expect(';');
  if (type == 3) in_.fail("value type 3; expected 0 for whole numbers, 1 for floats of 32 bits, 2 of 64");
  if (signal != nullptr) signal->type = static_cast<DbcValueType>(type);
}

void DbcParser::ranges() {
  DbcSignal* const signal = named_signal();
  DbcSignal found;
  found.multiplexor = in_.word("the multiplexor's name");
  do {
    const std::uint64_t from = in_.whole("a multiplexor's value", UINT64_MAX);
    in_.expect('-');
    found.ranges.emplace_back(from, in_.whole("a multiplexor's value", UINT64_MAX));
  } while (in_.take(','));
  in_.expect(';');
  if (signal == nullptr) return;
  signal->multiplexor = found.multiplexor;
  signal->ranges = found.ranges;
}

void DbcParser::attribute() {
  const std::string name = in_.string("an attribute's name");
  const auto known = std::ranges::find(dbc_attributes, name, &DbcAttribute::name);
  if (known == dbc_attributes.end()) return in_.skip_statement();
  if (in_.word("BO_, as of a message") != "BO_") in_.fail("attribute " + name + "; expected it of a message, BO_");
  const auto id = static_cast<std::uint32_t>(in_.whole("a message's id", most));
  const auto message = std::ranges::find(dbc_, id, &DbcMessage::file_id);
  if (message == dbc_.end()) in_.fail("no message of id " + std::to_string(id) + "; expected one that BO_ describes");
  const std::uint64_t value = in_.whole(known->name, known->highest);
  if (value < known->lowest) in_.fail(name + " 0; expected 1 or more");
  message->attributes[name] = static_cast<std::uint32_t>(value);
  in_.expect(';');
}

}  // namespace

Dbc read_dbc(const std::string& path) {
  return DbcParser(path).parse();
}

}  // namespace curbline::tools
