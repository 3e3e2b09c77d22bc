#include "format/export/geotiff/geotiff.h"

#include "format/export/geotiff/geotiff_module.h"
#include "format/system/module.h"

namespace gigabake {

std::unique_ptr<GeotiffFile> create_geotiff(const std::filesystem::path& target, const GeotiffImage& image,
                                            const GeotiffResources& resources) {
  static const GeotiffModule& module =
      *reinterpret_cast<decltype(&gigabake_geotiff)>(module_function("geotiff", "gigabake_geotiff"))();
  return module.create(target, image, resources);
}

}  // namespace gigabake
