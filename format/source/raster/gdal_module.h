/// The interface of the module "gdal", which implements the functions of format/source/raster/dem.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "format/area/crs_map.h"
#include "format/source/raster/dem.h"

namespace gigabake {

struct GdalModule {
  /// Sets the memory limit of the module, which has its own copy of core/base/memory_limit.h. Must be called before the
  /// other functions, with the limit of the program.
  void (*set_memory_limit)(std::uint64_t bytes);
  std::vector<DemSurface> (*open_dem)(const std::vector<DemOptions>& options, bool is_local);
  DemMesh (*read_dem)(const DemTile& tile, bool with_ortho);
  std::vector<std::filesystem::path> (*dem_files)(const DemTile& tile);
  /// Implements open_crs_map() of format/source/raster/crs_map.h.
  std::shared_ptr<const CrsMap> (*open_crs_map)(const std::string& text);
};

}  // namespace gigabake

/// Returns the functions of the module. No other symbol of the module is exported. The result is valid until the
/// process ends.
extern "C" const gigabake::GdalModule* gigabake_gdal();
