// A table of a TOML file, key by key: what robots and scenes are read from. Every call names the file, the line and the
// key when it throws BadInput, and done() refuses the keys that nobody asked for.
#pragma once

#include <toml++/toml.h>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "map/polygon.hpp"

namespace curbline::tools {

/// The text of a TOML file, at most 1 MiB of it. `kind` says in errors what was expected, "a robot file". Throws
/// BadInput.
std::string read_toml_text(const std::string& path, const std::string& kind);

/// Throws BadInput, with the line, if the text is no TOML.
toml::table parse_toml(const std::string& text, const std::string& path);

/// What a number may be, ends included.
struct Range {
  double lowest, highest;
};

class TomlTable {
 public:
  /// `table` outlives this. `name` is how errors call it, empty for the whole file.
  TomlTable(const toml::table& table, std::string name, std::string path)
      : table_(table), name_(std::move(name)), path_(std::move(path)) {}

  /// Asks for the key: done() then knows it.
  bool has(const char* key) { return find(key) != nullptr; }

  // A key that is absent leaves the value as it is: the default.
  void read(const char* key, double& value, Range range);
  void read(const char* key, float& value, Range range);
  void read(const char* key, bool& value);
  void read(const char* key, std::string& value);

  /// Whole numbers of any type that holds the range.
  template <typename Integer>
  void read_whole(const char* key, Integer& value, std::int64_t lowest, std::int64_t highest) {
    value = static_cast<Integer>(whole(key, static_cast<std::int64_t>(value), lowest, highest));
  }

  // These keys must be there.
  double number(const char* key, Range range);
  std::vector<double> numbers(const char* key, std::size_t count, Range range);    ///< exactly so many
  std::vector<Point2> points(const char* key, std::size_t at_least, Range range);  ///< [[x, y], ...]

  TomlTable table(const char* key);                ///< [key] or key = { ... }; empty if absent
  std::vector<TomlTable> tables(const char* key);  ///< of [[key]]; none if absent

  /// Throws BadInput if a key was not asked for. Call when every key has been read.
  void done() const;

  /// For what a range cannot say: throws BadInput at the key, or at the table if the key is absent.
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
