// What map and replay give out of a finished map.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "map/map.hpp"
#include "picture/picture.hpp"
#include "program/map_options.hpp"
#include "program/outputs.hpp"

namespace curbline::tools {

/// What give_out() would write to files.
std::vector<NamedFile> outputs_of(const MapOptions& options);

/// Writes the files that were asked for, all or none, and the summary with --json. `summary` may hold more to say.
void give_out(const MapOptions& options, const Map& map, const PictureExtras& picture, nlohmann::json summary);

}  // namespace curbline::tools
