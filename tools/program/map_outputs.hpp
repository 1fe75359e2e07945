// The outputs of map and replay for a finished map. Their files are opened before the work begins: one that cannot be
// written is refused at once, not after an hour of scan lines.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "command_line/outputs.hpp"
#include "formats/atomic_file.hpp"
#include "map/map.hpp"
#include "picture/picture.hpp"
#include "program/map_options.hpp"

namespace curbline::tools {

/// The files that MapOutputs would write.
std::vector<NamedFile> outputs_of(const MapOptions& options);

class MapOutputs {
 public:
  /// Throws BadInput if a requested file cannot be written, or a picture has another ending than .png or .svg.
  explicit MapOutputs(const MapOptions& options);

  /// Writes the requested files, all or none, and the summary with --json. `summary` may have further entries.
  void give_out(const Map& map, const PictureExtras& picture, nlohmann::json summary);

 private:
  MapOptions options_;
  std::optional<AtomicFile> labels_, curbs_, picture_;
};

}  // namespace curbline::tools
