/// Interface of the module "geotiff", which implements the functions of format/export/geotiff/geotiff.h with GDAL.
#pragma once

#include "format/export/geotiff/geotiff.h"

namespace gigabake {

struct GeotiffModule {
  std::unique_ptr<GeotiffFile> (*create)(const std::filesystem::path& target, const GeotiffImage& image,
                                         const GeotiffResources& resources);
};

}  // namespace gigabake

/// Returns the module, which lives as long as the process. This function is the only symbol that the library exports.
extern "C" const gigabake::GeotiffModule* gigabake_geotiff();
