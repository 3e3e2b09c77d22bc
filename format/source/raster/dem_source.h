/// Elevation rasters as sources of a scene.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "format/source/raster/dem.h"
#include "format/source/source.h"
#include "format/source/source_file.h"
#include "format/source/source_files.h"

namespace gigabake {

/// Returns one source per surface, in the order of their first rasters. A surface's frame is the scene's, and the
/// middle of its first raster the scene's origin unless the options say otherwise. root: that names are relative to.
/// Errors  InputError as open_dem().
std::vector<SceneSources> dem_sources(const std::filesystem::path& root, const std::vector<DemOptions>& rasters,
                                      const SourceOptions& options, const Progress& progress);

/// Returns the rasters that an entry of a scene file names: "dem", a file or a folder of rasters, and "ortho", "crs",
/// "ortho_crs", "nodata", "height_scale", "geoid_offset_m", "tile_cells".
/// Errors  InputError: a file outside the scene's folder, a value out of range.
std::vector<DemOptions> dem_options(const std::filesystem::path& scene_file, const Json& entry,
                                    const std::string& where);

/// Returns whether a name is that of a raster which a source may be: .tif, .tiff, .asc, .hgt, .vrt.
bool is_raster_name(const std::filesystem::path& path);

/// Returns whether a name is that of a raster in another format, which GDAL can convert.
bool is_other_raster_name(const std::filesystem::path& path);

/// Returns the rasters in a folder, without those that a VRT there may name.
std::vector<std::filesystem::path> rasters_in(const std::filesystem::path& folder);

TileMesh read_dem_tile(const TileRef& tile, ReadScope scope);

}  // namespace gigabake
