#include "robot/robot_table.hpp"

#include <array>
#include <charconv>
#include <fstream>
#include <sstream>

#include "formats/bad_input.hpp"

namespace curbline::tools {
namespace {

const toml::table empty_table;

long line_of(const toml::node& node) {
  return static_cast<long>(node.source().begin.line);
}

std::string shortest(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

/// A number or string as it is, anything else by its type.
std::string shown(const toml::node& node) {
  std::ostringstream text;
  if (node.is_number()) {
    text << shortest(node.value_or(0.0));
  } else if (const auto* string = node.as_string(); string != nullptr && string->get().size() <= 40) {
    text << *string;  // quoted and escaped
  } else {
    text << "of type " << node.type();
  }
  return text.str();
}

std::string read_text(const std::string& path) {
  constexpr std::size_t most = std::size_t{1} << 20;
  std::ifstream file(path, std::ios::binary);
  std::string text(most + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file.is_open() || file.bad()) throw BadInput(path + ": cannot be read; expected a robot file (TOML)");
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > most) throw BadInput(path + ": longer than 1 MiB; expected a robot file (TOML)");
  return text;
}

}  // namespace

toml::table RobotTable::parse(const std::string& path) {
  const std::string text = read_text(path);
  try {
    return toml::parse(text, path);
  } catch (const toml::parse_error& error) {
    std::string what(error.description());
    for (char& c : what) c = c == '\n' ? ' ' : c;
    throw BadInput(path, static_cast<long>(error.source().begin.line), what + "; expected TOML");
  }
}

std::string RobotTable::full_name(std::string_view key) const {
  return name_.empty() ? std::string(key) : name_ + "." + std::string(key);
}

const toml::node* RobotTable::find(const char* key) {
  known_.insert(key);
  return table_.get(key);
}

void RobotTable::refuse(const char* key, const std::string& why) const {
  const toml::node* const node = table_.get(key);
  throw BadInput(path_, line_of(node != nullptr ? *node : table_), full_name(key) + " " + why);
}

void RobotTable::refuse_value(const char* key, const toml::node& node, const std::string& expected) const {
  refuse(key, "is " + shown(node) + "; expected " + expected);
}

void RobotTable::read(const char* key, double& value, Range range) {
  const toml::node* const node = find(key);
  if (node == nullptr) return;
  const auto number = node->is_number() ? node->value<double>() : std::nullopt;
  if (!number || !(*number >= range.lowest && *number <= range.highest)) {
    refuse_value(key, *node, "a number from " + shortest(range.lowest) + " to " + shortest(range.highest));
  }
  value = *number;
}

void RobotTable::read(const char* key, float& value, Range range) {
  double wide = static_cast<double>(value);
  read(key, wide, range);
  value = static_cast<float>(wide);
}

void RobotTable::read(const char* key, bool& value) {
  const toml::node* const node = find(key);
  if (node == nullptr) return;
  if (!node->is_boolean()) refuse_value(key, *node, "true or false");
  value = node->as_boolean()->get();
}

void RobotTable::read(const char* key, std::string& value) {
  const toml::node* const node = find(key);
  if (node == nullptr) return;
  if (!node->is_string()) refuse_value(key, *node, "a string");
  value = node->as_string()->get();
}

std::int64_t RobotTable::whole(const char* key, std::int64_t value, std::int64_t lowest, std::int64_t highest) {
  const toml::node* const node = find(key);
  if (node == nullptr) return value;
  const auto* const number = node->as_integer();
  if (number == nullptr || number->get() < lowest || number->get() > highest) {
    refuse_value(key, *node, "a whole number from " + std::to_string(lowest) + " to " + std::to_string(highest));
  }
  return number->get();
}

RobotTable RobotTable::table(const char* key) {
  const toml::node* const node = find(key);
  if (node != nullptr && !node->is_table()) refuse_value(key, *node, "a table");
  return {node != nullptr ? *node->as_table() : empty_table, full_name(key), path_};
}

void RobotTable::done() const {
  for (const auto& [key, value] : table_) {
    if (known_.contains(key.str())) continue;
    std::string expected;
    for (const std::string& known : known_) expected += (expected.empty() ? "" : ", ") + known;
    throw BadInput(path_, static_cast<long>(key.source().begin.line),
                   "unknown key " + full_name(key.str()) + "; expected one of " + expected);
  }
}

}  // namespace curbline::tools
