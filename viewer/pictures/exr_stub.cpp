#include <stdexcept>

#include "viewer/pictures/image_files.h"

namespace gigabake {

std::optional<std::string> missing_openexr_error() {
  return "this gigabake was built without OpenEXR and cannot write .exr; build it with libopenexr-dev and "
         "-DGIGABAKE_OPENEXR=ON";
}

std::string encode_exr(const Picture&, ExrChannels, double) { throw std::runtime_error(*missing_openexr_error()); }

void write_exr(const std::filesystem::path&, const Picture& picture, ExrChannels channels, double voxel_size_m) {
  encode_exr(picture, channels, voxel_size_m);
}

}  // namespace gigabake
