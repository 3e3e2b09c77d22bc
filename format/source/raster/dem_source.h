/// Elevation rasters as sources of a scene.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "format/source/raster/dem.h"
#include "format/source/source.h"
#include "format/source/source_file.h"
#include "format/source/source_files.h"
#include "format/system/json/json_members.h"

namespace gigabake {

/// Returns one source per surface, in the order of their first rasters. Names are relative to `root`. The origin of a
/// source is the centre of the first raster of the surface, unless the options set another origin or none (`local`).
/// Errors  InputError like open_dem().
std::vector<SceneSources> dem_sources(const std::filesystem::path& root, const std::vector<DemOptions>& rasters,
                                      const SourceOptions& options, const Progress& progress);

/// Returns the rasters that an entry of a scene file names, with their options.
/// "dem" is a file or a folder of rasters. The other keys are "ortho", "crs", "ortho_crs", "nodata", "height_scale",
/// "geoid_offset_m" and "tile_cells".
/// Errors  InputError: a file is missing or outside the folder of the scene, or a value is out of range.
std::vector<DemOptions> dem_options(const JsonMembers& entry);

/// Returns whether a file name has the extension of a supported raster: .tif, .tiff, .asc, .hgt, .vrt.
bool is_raster_name(const std::filesystem::path& path);

/// Returns whether a file name has the extension of another raster format, which GDAL can convert.
bool is_other_raster_name(const std::filesystem::path& path);

/// Returns the sorted rasters in a folder: only the VRTs if there are any, because they may name the other rasters.
std::vector<std::filesystem::path> rasters_in(const std::filesystem::path& folder);

TileMesh read_dem_tile(const TileRef& tile, ReadScope scope);

}  // namespace gigabake
