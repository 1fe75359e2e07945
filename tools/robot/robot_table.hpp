// A table of a robot file, key by key. Every call names the file, the line and the key when it throws BadInput, and
// done() refuses the keys that nobody asked for. A key that is absent leaves the value as it is: the default.
#pragma once

#include <toml++/toml.h>
#include <cstdint>
#include <set>
#include <string>

namespace curbline::tools {

/// What a number may be, ends included.
struct Range {
  double lowest, highest;
};

class RobotTable {
 public:
  /// Parses a file; both outlive the tables taken from them. Throws BadInput if it cannot be read or is no TOML.
  static toml::table parse(const std::string& path);

  /// `name` is how errors call the table, empty for the whole file.
  RobotTable(const toml::table& table, std::string name, const std::string& path)
      : table_(table), name_(std::move(name)), path_(path) {}

  void read(const char* key, double& value, Range range);
  void read(const char* key, float& value, Range range);
  void read(const char* key, bool& value);
  void read(const char* key, std::string& value);

  /// Whole numbers of any type that holds the range.
  template <typename Integer>
  void read_whole(const char* key, Integer& value, std::int64_t lowest, std::int64_t highest) {
    value = static_cast<Integer>(whole(key, static_cast<std::int64_t>(value), lowest, highest));
  }

  bool has(const char* key) { return find(key) != nullptr; }

  RobotTable table(const char* key);  ///< empty if absent

  /// Throws BadInput if a key was not asked for. Call when every key has been read.
  void done() const;

  /// For what a range cannot say: throws BadInput at the key, or at the table if the key is absent.
  [[noreturn]] void refuse(const char* key, const std::string& why) const;

 private:
  const toml::node* find(const char* key);
  std::int64_t whole(const char* key, std::int64_t value, std::int64_t lowest, std::int64_t highest);
  std::string full_name(std::string_view key) const;
  [[noreturn]] void refuse_value(const char* key, const toml::node& node, const std::string& expected) const;

  const toml::table& table_;
  std::string name_;
  const std::string& path_;
  std::set<std::string, std::less<>> known_;
};

}  // namespace curbline::tools
