// A table of a scene file, key by key: every getter names file, line and key when it throws BadInput, and done()
// refuses the keys that nobody asked for.
#pragma once

#include "formats/bad_input.hpp"
#include "simulator/polygon.hpp"

#include <toml++/toml.h>
#include <set>
#include <string>
#include <vector>

namespace curbline::tools {

class SceneTable {
 public:
  SceneTable(const toml::table& table, std::string file) : table_(table), file_(std::move(file)) {}

  bool has(const char* key) const { return table_.contains(key); }

  double number(const char* key, double otherwise);
  double required_number(const char* key);
  double positive(const char* key, double otherwise);
  double required_positive(const char* key);
  std::vector<double> numbers(const char* key, std::size_t count);  ///< exactly so many; the key must be there
  Point2 point(const char* key, Point2 otherwise);
  std::vector<Point2> points(const char* key, std::size_t at_least);
  std::string text(const char* key, const std::string& otherwise);
  std::vector<SceneTable> tables(const char* key);  ///< of [[key]]; none if there is none
  SceneTable table(const char* key);                ///< [key] or key = { ... }; empty if there is none

  void done() const;
  [[noreturn]] void refuse(const char* key,
                           const std::string& why) const;  ///< the key, or the table if it lacks the key

 private:
  const toml::node* find(const char* key);
  const toml::array& array(const char* key, const char* expected);
  double element(const toml::node& node, const char* key) const;

  const toml::table& table_;
  std::string file_;
  std::set<std::string, std::less<>> known_;
};

}  // namespace curbline::tools
