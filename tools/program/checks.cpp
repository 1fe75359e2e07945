#include "program/checks.hpp"

#include <charconv>
#include <cmath>
#include <cstdlib>

namespace curbline::tools {

CLI::Validator file_name() {
  return not_empty("a file name");
}

CLI::Validator not_empty(const std::string& expected) {
  return CLI::Validator([=](const std::string& name) { return name.empty() ? "empty; expected " + expected : ""; }, "");
}

CLI::Validator within(double low, double high, const std::string& expected) {
  const auto check = [=](const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    return value >= low && value <= high && *end == '\0' ? "" : text + "; expected " + expected;
  };
  return CLI::Validator(check, "");
}

CLI::Validator whole_number(std::uint64_t low, std::uint64_t high) {
  const auto check = [=](const std::string& text) {
    std::uint64_t value = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool good = problem == std::errc{} && end == text.data() + text.size() && value >= low && value <= high;
    return good ? "" : text + "; expected a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  };
  return CLI::Validator(check, "");
}

double parse_speed(const std::string& text) {
  if (text == "max") return 0;
  double speed = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), speed);
  if (failed != std::errc{} || end != text.data() + text.size() || !(speed > 0) || !std::isfinite(speed))
    throw CLI::ValidationError("--speed", text + "; expected max or a finite number above 0");
  return speed;
}

}  // namespace curbline::tools
