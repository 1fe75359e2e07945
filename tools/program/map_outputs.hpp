// The outputs of map and replay for a finished map.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "command_line/outputs.hpp"
#include "map/map.hpp"
#include "picture/picture.hpp"
#include "program/map_options.hpp"

namespace curbline::tools {

/// The files that give_out() would write.
std::vector<NamedFile> outputs_of(const MapOptions& options);

/// Before the work begins: check_writable(), and throws BadInput if a picture has another ending than .png or .svg.
void check_map_outputs(const MapOptions& options);

/// Writes the requested files, all or none, and the summary with --json. `summary` may have further entries.
void give_out(const MapOptions& options, const Map& map, const PictureExtras& picture, nlohmann::json summary);

}  // namespace curbline::tools
