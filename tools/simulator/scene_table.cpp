#include "simulator/scene_table.hpp"

#include <cmath>

namespace curbline::tools {
namespace {

constexpr double largest = 1e5;  // metres, metres a second or degrees: beyond, it is a slip of the pen

const toml::table empty_table;

long line_of(const toml::node& node) {
  return static_cast<long>(node.source().begin.line);
}

}  // namespace

const toml::node* SceneTable::find(const char* key) {
  known_.insert(key);
  return table_.get(key);
}

void SceneTable::refuse(const char* key, const std::string& why) const {
  const toml::node* node = table_.get(key);
  throw BadInput(file_, line_of(node != nullptr ? *node : table_), std::string(key) + ": " + why);
}

double SceneTable::element(const toml::node& node, const char* key) const {
  const auto value = node.value<double>();
  if (!node.is_number() || !value || !(std::abs(*value) <= largest)) {
    throw BadInput(file_, line_of(node), std::string(key) + ": not a number within +-1e5");
  }
  return *value;
}

double SceneTable::number(const char* key, double otherwise) {
  const toml::node* node = find(key);
  return node == nullptr ? otherwise : element(*node, key);
}

double SceneTable::required_number(const char* key) {
  if (find(key) == nullptr) {
    refuse(key, "missing; expected a number");
  }
  return number(key, 0);
}

double SceneTable::positive(const char* key, double otherwise) {
  const double value = number(key, otherwise);
  if (!(value > 0)) {
    refuse(key, "not above 0");
  }
  return value;
}

double SceneTable::required_positive(const char* key) {
  required_number(key);
  return positive(key, 0);
}

const toml::array& SceneTable::array(const char* key, const char* expected) {
  const toml::node* node = find(key);
  if (node == nullptr || !node->is_array()) {
    refuse(key, std::string(node == nullptr ? "missing" : "not an array") + "; expected " + expected);
  }
  return *node->as_array();
}

std::vector<double> SceneTable::numbers(const char* key, std::size_t count) {
  const std::string expected = "[" + std::to_string(count) + " numbers]";
  const toml::array& values = array(key, expected.c_str());
  if (values.size() != count) {
    refuse(key, std::to_string(values.size()) + " elements; expected " + expected);
  }
  std::vector<double> out;
  for (const toml::node& value : values) {
    out.push_back(element(value, key));
  }
  return out;
}

Point2 SceneTable::point(const char* key, Point2 otherwise) {
  if (find(key) == nullptr) {
    return otherwise;
  }
  const std::vector<double> xy = numbers(key, 2);
  return {xy[0], xy[1]};
}

std::vector<Point2> SceneTable::points(const char* key, std::size_t at_least) {
  std::vector<Point2> out;
  for (const toml::node& value : array(key, "[[x, y], ...]")) {
    const toml::array* pair = value.as_array();
    if (pair == nullptr || pair->size() != 2) {
      throw BadInput(file_, line_of(value), std::string(key) + ": not a point; expected [x, y]");
    }
    out.push_back({element((*pair)[0], key), element((*pair)[1], key)});
  }
  if (out.size() < at_least) {
    refuse(key, std::to_string(out.size()) + " points; expected at least " + std::to_string(at_least));
  }
  return out;
}

std::string SceneTable::text(const char* key, const std::string& otherwise) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return otherwise;
  }
  if (!node->is_string()) {
    refuse(key, "not a string");
  }
  return node->as_string()->get();
}

std::vector<SceneTable> SceneTable::tables(const char* key) {
  std::vector<SceneTable> out;
  if (find(key) == nullptr) {
    return out;
  }
  const std::string expected = std::string("tables headed [[") + key + "]]";
  for (const toml::node& value : array(key, expected.c_str())) {
    if (!value.is_table()) {
      refuse(key, "not a table; expected " + expected);
    }
    out.emplace_back(*value.as_table(), file_);
  }
  return out;
}

SceneTable SceneTable::table(const char* key) {
  const toml::node* node = find(key);
  if (node != nullptr && !node->is_table()) {
    refuse(key, "not a table");
  }
  return {node == nullptr ? empty_table : *node->as_table(), file_};
}

void SceneTable::done() const {
  for (const auto& [key, value] : table_) {
    if (!known_.contains(std::string_view(key))) {
      throw BadInput(file_, static_cast<long>(key.source().begin.line), "unknown key '" + std::string(key.str()) + "'");
    }
  }
}

}  // namespace curbline::tools
