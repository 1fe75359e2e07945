// Reads a whole file, for formats that are not read line by line.
#pragma once

#include <cstddef>
#include <string>

namespace curbline::tools {

/// The bytes of the file. `expected` states in errors what it should be, "a DBC file". Throws BadInput, with the
/// reason, if it cannot be read or is longer than `most_mib`; no more than that is read.
std::string read_whole(const std::string& path, std::size_t most_mib, const std::string& expected);

}  // namespace curbline::tools
