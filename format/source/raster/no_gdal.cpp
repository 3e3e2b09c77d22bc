#include "format/source/raster/dem.h"
#include "lattice/error.h"

namespace gigabake {

std::vector<DemTile> open_dem(const DemOptions& options) {
  throw InputError(options.dem, "dem", "this gigabake was built without GDAL; install libgdal-dev and build again");
}

// No tile can be made, so neither of these runs.
DemMesh read_dem(const DemTile&, bool) { return {}; }
std::vector<std::filesystem::path> dem_files(const DemOptions&) { return {}; }

}  // namespace gigabake
