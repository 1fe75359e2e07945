// What the values of options are checked with, of all programs: each says of a bad one what was expected.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

namespace curbline::tools {

/// What an option that names a file or a directory is checked with: an empty name, as a shell's unset variable gives,
/// would be taken for none.
CLI::Validator file_name();
CLI::Validator not_empty(const std::string& expected);  ///< the same, for other names

/// Numbers in [low, high]; `expected` says so for the user, with the unit.
CLI::Validator within(double low, double high, const std::string& expected);

/// Of 64 bits. CLI11 takes -1 for the greatest.
CLI::Validator whole_number(std::uint64_t low = 0, std::uint64_t high = UINT64_MAX);

/// Of --speed: max, or times as fast as the log.
CLI::Validator speed();
double parse_speed(const std::string& text);  ///< of what speed() lets through; 0 for max

}  // namespace curbline::tools
