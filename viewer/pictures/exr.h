/// A picture as an OpenEXR file: light as it is, and how far away things are.
#pragma once

#include <filesystem>
#include <string>

#include "viewer/pictures/picture.h"

namespace gigabake {

/// R, G, B, A: half, linear, premultiplied. Z: float, metres along the ray to where half of the light is gone; infinity
/// where it never is.
enum class ExrChannels : std::uint8_t {
  light_and_depth,  ///< R, G, B, A and Z; needs Picture::linear
  depth,            ///< Z
};

/// Lines upwards to downwards, ZIP. voxel_size_m: turns Picture::depth into metres.
/// Exact   Equal pictures give equal bytes. Errors  std::runtime_error: OpenEXR's message; no picture.
std::string encode_exr(const Picture& picture, ExrChannels channels, double voxel_size_m);

/// As encode_exr(). Replaces `path` atomically.
/// Errors  InputError: the path and the system's reason; nothing is left behind.
void write_exr(const std::filesystem::path& path, const Picture& picture, ExrChannels channels, double voxel_size_m);

}  // namespace gigabake
