// Validators for the values of options, for all programs: each says what was expected instead of a bad value.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

namespace curbline::tools {

/// For an option that names a file or a directory: an empty name, as from an unset variable of the shell, would be
/// taken as no option.
CLI::Validator file_name();
CLI::Validator not_empty(const std::string& expected);  ///< the same, for other names

/// Numbers in [low, high]; `expected` states the range and the unit for the user.
CLI::Validator within(double low, double high, const std::string& expected);

/// A whole number of 64 bits. CLI11 by itself takes -1 for the greatest.
CLI::Validator whole_number(std::uint64_t low = 0, std::uint64_t high = UINT64_MAX);

/// For --speed: max, or a factor relative to the log's speed.
CLI::Validator speed();
double parse_speed(const std::string& text);  ///< of a text that speed() accepts; 0 for max

}  // namespace curbline::tools
