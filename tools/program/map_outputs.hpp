// The outputs of map and replay for a finished map.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "map/map.hpp"
#include "picture/picture.hpp"
#include "program/map_options.hpp"
#include "program/outputs.hpp"

namespace curbline::tools {

/// The files that give_out() would write.
std::vector<NamedFile> outputs_of(const MapOptions& options);

/// Writes the requested files, all or none, and the summary with --json. `summary` may have further entries.
void give_out(const MapOptions& options, const Map& map, const PictureExtras& picture, nlohmann::json summary);

}  // namespace curbline::tools
