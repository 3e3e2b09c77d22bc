/// Elevation rasters as sources of a scene.
#pragma once

#include <filesystem>

#include "format/source/raster/dem.h"
#include "format/source/source.h"
#include "format/source/source_file.h"
#include "format/source/source_files.h"

namespace gigabake {

/// The tiles of one raster; its frame is the scene's, and its middle the scene's origin unless the options say
/// otherwise. root: that names are relative to. Errors  InputError as open_dem().
SceneSources dem_sources(const std::filesystem::path& root, const DemOptions& dem, const SourceOptions& options,
                         const Progress& progress);

/// What an entry of a scene file says: "dem", "ortho", "crs", "nodata", "height_scale", "geoid_offset_m", "tile_cells".
/// Errors  InputError: a file outside the scene's folder, a value out of range.
DemOptions dem_options(const std::filesystem::path& scene_file, const Json& entry, const std::string& where);

TileMesh read_dem_tile(const TileRef& tile, ReadScope scope);

}  // namespace gigabake
