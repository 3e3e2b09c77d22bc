/// A scene .json: sources listed with their placements (docs/format.md).
#pragma once

#include <filesystem>

#include "format/source/source.h"
#include "format/source/source_file.h"

namespace gigabake {

/// Opens a scene. Format:
/// {"gigabake": 1, "sources": [{"path": "…", "place": {"position_m": [x,y,z]} or {"lon_lat_height": [lon,lat,h]},
///  "heading_deg": 0, "scale": 1}, …]}.
/// A source may be an elevation raster: {"dem": "…", "ortho": "…", …}, see dem_options(). "heading_deg" rotates the
/// source clockwise from north (y), seen from above. Without "place" a georeferenced tileset keeps its position on the
/// earth. "edits" lists edits, see edits_of() in format/edit/edit_json.h.
/// Errors  InputError like open_sources(). Also for unknown keys, nested scenes, or local and geodetic placements in
///         one scene.
SceneSources open_scene_json(const std::filesystem::path& file, const Json& json, const SourceOptions& options,
                             const Progress& progress);

}  // namespace gigabake
