// A table of a TOML file, read key by key, for robots and scenes. All calls that throw BadInput name the file, the line
// and the key; done() refuses the keys that were not read.
#pragma once

#include <toml++/toml.h>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "curbline/setting_ranges.hpp"
#include "map/polygon.hpp"

namespace curbline::tools {

/// The text of a TOML file of at most 1 MiB. `kind` states in errors what was expected, "a robot file". Throws
/// BadInput.
std::string read_toml_text(const std::string& path, const std::string& kind);

/// Throws BadInput, with the line, if the text is not TOML.
toml::table parse_toml(const std::string& text, const std::string& path);

/// The range of a number, inclusive.
using Range = SettingRange;

class TomlTable {
 public:
  /// `table` must outlive this object. `name` is used in errors; empty for the whole file.
  TomlTable(const toml::table& table, std::string name, std::string path)
      : table_(table), name_(std::move(name)), path_(std::move(path)) {}

  /// Also makes the key known to done().
  bool has(const char* key) { return find(key) != nullptr; }

  // If the key is absent, the value keeps its default.
  void read(const char* key, double& value, Range range);
  void read(const char* key, float& value, Range range);
  void read(const char* key, bool& value);
  void read(const char* key, std::string& value);

  /// Whole numbers, of any type that can represent the range.
  template <typename Integer>
  void read_whole(const char* key, Integer& value, std::int64_t lowest, std::int64_t highest) {
    value = static_cast<Integer>(whole(key, static_cast<std::int64_t>(value), lowest, highest));
  }

  // These keys are required.
  double number(const char* key, Range range);
  std::vector<double> numbers(const char* key, std::size_t count, Range range);    ///< exactly this many
  std::vector<Point2> points(const char* key, std::size_t at_least, Range range);  ///< [[x, y], ...]

  TomlTable table(const char* key);                ///< [key] or key = { ... }; empty if absent
  std::vector<TomlTable> tables(const char* key);  ///< all [[key]]; empty if absent

  /// Throws BadInput if there is a key that was not read. Call it after reading all keys.
  void done() const;

  /// For conditions beyond a range: throws BadInput at the key, or at the table if the key is absent.
  [[noreturn]] void refuse(const char* key, const std::string& why) const;
  [[noreturn]] void refuse_word(const char* key, const std::string& word, const std::string& expected) const;

 private:
  const toml::node* find(const char* key);
  const toml::array& array(const char* key, const std::string& expected);
  double checked(const char* key, const toml::node& node, Range range) const;
  std::int64_t whole(const char* key, std::int64_t value, std::int64_t lowest, std::int64_t highest);
  std::string full_name(std::string_view key) const;
  [[noreturn]] void refuse_value(const char* key, const toml::node& node, const std::string& expected) const;

  const toml::table& table_;
  std::string name_;
  std::string path_;
  std::set<std::string, std::less<>> known_;
};

}  // namespace curbline::tools
