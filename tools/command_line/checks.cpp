#include "command_line/checks.hpp"

#include <cstdlib>

#include "formats/parse_number.hpp"

namespace curbline::tools {
namespace {

std::string refusal(const std::string& text, const std::string& expected) {
  return (text.empty() ? "empty" : text) + "; expected " + expected;
}

}  // namespace

CLI::Validator file_name() {
  return not_empty("a file name");
}

CLI::Validator not_empty(const std::string& expected) {
  return CLI::Validator([=](const std::string& name) { return name.empty() ? refusal(name, expected) : ""; }, "");
}

CLI::Validator within(double low, double high, const std::string& expected) {
  const auto check = [=](const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    const bool good = !text.empty() && value >= low && value <= high && *end == '\0';
    return good ? "" : refusal(text, expected);
  };
  return CLI::Validator(check, "");
}

CLI::Validator whole_number(std::uint64_t low, std::uint64_t high) {
  const auto check = [=](const std::string& text) {
    const auto value = parse_number<std::uint64_t>(text);
    const bool good = value && *value >= low && *value <= high;
    return good ? "" : refusal(text, "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
  };
  return CLI::Validator(check, "");
}

CLI::Validator speed() {
  const CLI::Validator number = within(0.001, 1000, "max or a number from 0.001 to 1000");
  return CLI::Validator([=](const std::string& text) { return text == "max" ? "" : number(text); }, "");
}

double parse_speed(const std::string& text) {
  return text == "max" ? 0 : std::strtod(text.c_str(), nullptr);
}

}  // namespace curbline::tools
