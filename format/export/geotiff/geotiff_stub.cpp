#include "core/base/error.h"
#include "format/export/geotiff/geotiff.h"

namespace gigabake {

std::unique_ptr<GeotiffFile> create_geotiff(const std::filesystem::path&, const GeotiffImage&,
                                            const GeotiffResources&) {
  throw UsageError(
      "`to` dsm, ortho and classes: this gigabake was built without GDAL; install libgdal-dev and build again");
}

}  // namespace gigabake
