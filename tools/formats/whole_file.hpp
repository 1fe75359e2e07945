// A file read at once, for formats that are not read line by line.
#pragma once

#include <cstddef>
#include <string>

namespace curbline::tools {

/// Its bytes. `expected` says in errors what it should be, "a DBC file". Throws BadInput, with the reason, if it cannot
/// be read, and if it is longer than `most_mib`; of that no more is kept.
std::string read_whole(const std::string& path, std::size_t most_mib, const std::string& expected);

}  // namespace curbline::tools
