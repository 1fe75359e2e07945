#include "formats/toml_table.hpp"

#include <algorithm>
#include <sstream>

#include "formats/bad_input.hpp"
#include "formats/decimals.hpp"
#include "formats/whole_file.hpp"

namespace curbline::tools {
namespace {

const toml::table empty_table;

long line_of(const toml::node& node) {
  return static_cast<long>(node.source().begin.line);
}

/// As TOML writes it: 1081 and 1081.0 differ.
std::string shown_number(const toml::node& node) {
  if (const auto* whole = node.as_integer()) return std::to_string(whole->get());
  const std::string text = shortest(node.value_or(0.0));
  return text.find_first_not_of("-0123456789") == std::string::npos ? text + ".0" : text;
}

/// A string of the file, shortened and escaped to fit one line of a terminal.
std::string in_one_line(std::string_view text) {
  constexpr std::string_view digits = "0123456789abcdef";
  constexpr std::size_t most = 200;
  std::string out;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    const bool within_utf8 = (code & 0xC0) == 0x80;
    if (out.size() >= most && !within_utf8) return out + "...";
    if (c == '\n') {
      out += "\\n";
    } else if (code < ' ' || code == 0x7F) {
      out += {'\\', 'x', digits[code >> 4], digits[code & 15]};
    } else {
      out += c;
    }
  }
  return out;
}

/// A number or string as it is; the type for anything else.
std::string shown(const toml::node& node) {
  std::ostringstream text;
  if (node.is_number()) {
    text << shown_number(node);
  } else if (const auto* string = node.as_string(); string != nullptr && string->get().size() <= 40) {
    text << *string;  // quoted
  } else {
    text << "of type " << node.type();
  }
  return in_one_line(text.str());
}

/// The position after the string that begins at text[i]. An unterminated string of a single line ends at the line's
/// end.
std::size_t behind_string(std::string_view text, std::size_t i) {
  const char quote = text[i];
  const bool multi_line = text.substr(i, 3) == std::string(3, quote);
  for (i += multi_line ? 3 : 1; i < text.size(); ++i) {
    if (text[i] == '\n' && !multi_line) return i;
    if (text[i] == '\\' && quote == '"' && (multi_line || text.substr(i + 1, 1) != "\n")) {
      ++i;
    } else if (text[i] == quote) {
      if (!multi_line) return i + 1;
      const std::size_t quotes = std::min(text.find_first_not_of(quote, i), text.size()) - i;
      if (quotes >= 3) return i + std::min<std::size_t>(quotes, 5);  // two may belong to the string
    }
  }
  return text.size();
}

/// toml++ recurses for each part of a dotted key without a limit, so the stack would overflow. For nested values it has
/// its own limit, also 256.
void refuse_deep_keys(std::string_view text, const std::string& path) {
  constexpr int most = 256;
  long line = 1;
  int dots = 0;  // in what may be a key
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      const std::size_t end = behind_string(text, i);
      const std::string_view string = text.substr(i, end - i);
      line += static_cast<long>(std::count(string.begin(), string.end(), '\n'));
      i = end;
      continue;
    }
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
      continue;
    }
    ++i;
    line += c == '\n';
    if (c == '.') {
      if (++dots >= most) throw BadInput(path, line, "a key is too deep; expected at most 256 parts");
    } else if (std::string_view("\n=,[]{}").find(c) != std::string_view::npos) {
      dots = 0;
    }
  }
}

}  // namespace

std::string read_toml_text(const std::string& path, const std::string& kind) {
  return read_whole(path, 1, kind + " (TOML)");
}

toml::table parse_toml(const std::string& text, const std::string& path) {
  refuse_deep_keys(text, path);
  try {
    return toml::parse(text, path);
  } catch (const toml::parse_error& error) {
    throw BadInput(path, static_cast<long>(error.source().begin.line),
                   in_one_line(error.description()) + "; expected TOML");
  }
}

std::string TomlTable::full_name(std::string_view key) const {
  return name_.empty() ? std::string(key) : name_ + "." + std::string(key);
}

const toml::node* TomlTable::find(const char* key) {
  known_.insert(key);
  return table_.get(key);
}

void TomlTable::refuse(const char* key, const std::string& why) const {
  const toml::node* const node = table_.get(key);
  throw BadInput(path_, line_of(node != nullptr ? *node : table_), full_name(key) + " " + why);
}

void TomlTable::refuse_word(const char* key, const std::string& word, const std::string& expected) const {
  refuse(key, "is \"" + in_one_line(word) + "\"; expected " + expected);
}

void TomlTable::refuse_value(const char* key, const toml::node& node, const std::string& expected) const {
  throw BadInput(path_, line_of(node), full_name(key) + " is " + shown(node) + "; expected " + expected);
}

double TomlTable::checked(const char* key, const toml::node& node, Range range) const {
  const auto number = node.is_number() ? node.value<double>() : std::nullopt;
  if (!number || !(*number >= range.lowest && *number <= range.highest)) {
    refuse_value(key, node, "a number from " + shortest(range.lowest) + " to " + shortest(range.highest));
  }
  return *number;
}

void TomlTable::read(const char* key, double& value, Range range) {
  if (const toml::node* const node = find(key); node != nullptr) value = checked(key, *node, range);
}

void TomlTable::read(const char* key, float& value, Range range) {
  double wide = static_cast<double>(value);
  read(key, wide, range);
  value = static_cast<float>(wide);
}

void TomlTable::read(const char* key, bool& value) {
  const toml::node* const node = find(key);
  if (node == nullptr) return;
  if (!node->is_boolean()) refuse_value(key, *node, "true or false");
  value = node->as_boolean()->get();
}

void TomlTable::read(const char* key, std::string& value) {
  const toml::node* const node = find(key);
  if (node == nullptr) return;
  if (!node->is_string()) refuse_value(key, *node, "a string");
  value = node->as_string()->get();
}

std::int64_t TomlTable::whole(const char* key, std::int64_t value, std::int64_t lowest, std::int64_t highest) {
  const toml::node* const node = find(key);
  if (node == nullptr) return value;
  const auto* const number = node->as_integer();
  if (number == nullptr || number->get() < lowest || number->get() > highest) {
    refuse_value(key, *node, "a whole number from " + std::to_string(lowest) + " to " + std::to_string(highest));
  }
  return number->get();
}

double TomlTable::number(const char* key, Range range) {
  if (find(key) == nullptr) refuse(key, "is missing; expected a number");
  double value = 0;
  read(key, value, range);
  return value;
}

const toml::array& TomlTable::array(const char* key, const std::string& expected) {
  const toml::node* const node = find(key);
  if (node == nullptr) refuse(key, "is missing; expected " + expected);
  if (!node->is_array()) refuse_value(key, *node, expected);
  return *node->as_array();
}

std::vector<double> TomlTable::numbers(const char* key, std::size_t count, Range range) {
  const std::string expected = "an array of " + std::to_string(count) + " numbers";
  const toml::array& values = array(key, expected);
  if (values.size() != count) refuse(key, "has " + std::to_string(values.size()) + " elements; expected " + expected);
  std::vector<double> out;
  for (const toml::node& value : values) out.push_back(checked(key, value, range));
  return out;
}

std::vector<Point2> TomlTable::points(const char* key, std::size_t at_least, Range range) {
  std::vector<Point2> out;
  for (const toml::node& value : array(key, "an array of points, [[x, y], ...]")) {
    const toml::array* const pair = value.as_array();
    if (pair == nullptr || pair->size() != 2) refuse_value(key, value, "points, [[x, y], ...]");
    out.push_back({checked(key, (*pair)[0], range), checked(key, (*pair)[1], range)});
  }
  if (out.size() < at_least) {
    refuse(key, "has " + std::to_string(out.size()) + " points; expected at least " + std::to_string(at_least));
  }
  return out;
}

TomlTable TomlTable::table(const char* key) {
  const toml::node* const node = find(key);
  if (node != nullptr && !node->is_table()) refuse_value(key, *node, "a table");
  return {node != nullptr ? *node->as_table() : empty_table, full_name(key), path_};
}

std::vector<TomlTable> TomlTable::tables(const char* key) {
  std::vector<TomlTable> out;
  if (find(key) == nullptr) return out;
  const std::string expected = "tables headed [[" + full_name(key) + "]]";
  for (const toml::node& value : array(key, expected)) {
    if (!value.is_table()) refuse_value(key, value, expected);
    out.emplace_back(*value.as_table(), full_name(key), path_);
  }
  return out;
}

void TomlTable::done() const {
  for (const auto& [key, value] : table_) {
    if (known_.contains(key.str())) continue;
    std::string expected;
    for (const std::string& known : known_) expected += (expected.empty() ? "" : ", ") + known;
    throw BadInput(path_, static_cast<long>(key.source().begin.line),
                   "unknown key " + in_one_line(full_name(key.str())) + "; expected one of " + expected);
  }
}

}  // namespace curbline::tools
