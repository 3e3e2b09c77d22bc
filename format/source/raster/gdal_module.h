/// What the module "gdal" does: the functions of format/source/raster/dem.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "format/source/raster/dem.h"

namespace gigabake {

struct GdalModule {
  /// The module has its own lattice/memory_limit.h. To be called before the others, with the program's limit.
  void (*set_memory_limit)(std::uint64_t bytes);
  std::vector<DemSurface> (*open_dem)(const std::vector<DemOptions>& options, bool is_local);
  DemMesh (*read_dem)(const DemTile& tile, bool with_ortho);
  std::vector<std::filesystem::path> (*dem_files)(const DemTile& tile);
};

}  // namespace gigabake

/// The module's only symbol. Its lifetime is the process's.
extern "C" const gigabake::GdalModule* gigabake_gdal();
