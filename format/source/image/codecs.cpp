#include "format/source/image/codecs.h"

namespace gigabake {

std::optional<std::string> missing_codec(const std::string& extension) {
  const auto without = [&](const char* package) {
    return "this gigabake was built without the library for " + extension + "; install " + package + " and build again";
  };
  if (extension == "EXT_meshopt_compression" && !has_meshopt()) return without("libmeshoptimizer-dev");
  if (extension == "KHR_draco_mesh_compression" && !has_draco()) return without("libdraco-dev");
  if (extension == "EXT_texture_webp" && !has_webp()) return without("libwebp-dev");
  if (extension == "KHR_texture_basisu")
    return "the extension KHR_texture_basisu is not supported: no packaged library decodes it; convert the images to "
           "PNG, JPEG or WebP";
  return std::nullopt;
}

}  // namespace gigabake
