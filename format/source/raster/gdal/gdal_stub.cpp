#include "core/base/error.h"
#include "format/source/raster/crs_map.h"
#include "format/source/raster/dem.h"

namespace gigabake {

std::vector<DemSurface> open_dem(const std::vector<DemOptions>& options, bool) {
  throw InputError(options.at(0).dem, "dem",
                   "this gigabake was built without GDAL; install libgdal-dev and build again");
}

std::shared_ptr<const CrsMap> open_crs_map(const std::string&) {
  throw InputError("", "crs", "this gigabake was built without GDAL; install libgdal-dev and build again");
}

// These functions are never called, because open_dem() throws and thus no tile exists.
DemMesh read_dem(const DemTile&, bool) { return {}; }
std::vector<std::filesystem::path> dem_files(const DemTile&) { return {}; }

}  // namespace gigabake
