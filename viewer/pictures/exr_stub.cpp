#include <stdexcept>

#include "viewer/pictures/exr.h"

namespace gigabake {

bool has_exr() { return false; }

std::string encode_exr(const Picture&, ExrChannels, double) {
  throw std::runtime_error("cannot make an EXR: this gigabake was built without OpenEXR");
}

void write_exr(const std::filesystem::path&, const Picture& picture, ExrChannels channels, double voxel_size_m) {
  encode_exr(picture, channels, voxel_size_m);
}

}  // namespace gigabake
