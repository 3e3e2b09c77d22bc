// Implements format/source/raster/dem.h and crs_map.h in builds with GDAL. The module is loaded at first use, because
// loading GDAL takes 0.1 s and 50 MB.
#include "core/base/memory_limit.h"
#include "format/source/raster/crs_map.h"
#include "format/source/raster/gdal_module.h"
#include "format/system/module.h"

namespace gigabake {
namespace {

const GdalModule& gdal() {
  static const GdalModule& module =
      *reinterpret_cast<decltype(&gigabake_gdal)>(module_function("gdal", "gigabake_gdal"))();
  module.set_memory_limit(memory_limit());
  return module;
}

}  // namespace

std::vector<DemSurface> open_dem(const std::vector<DemOptions>& options, bool is_local) {
  return gdal().open_dem(options, is_local);
}
DemMesh read_dem(const DemTile& tile, bool with_ortho) { return gdal().read_dem(tile, with_ortho); }
std::vector<std::filesystem::path> dem_files(const DemTile& tile) { return gdal().dem_files(tile); }
std::shared_ptr<const CrsMap> open_crs_map(const std::string& text) { return gdal().open_crs_map(text); }

}  // namespace gigabake
