/// Images as files: PNG, JPEG for streams, and OpenEXR for linear light and depth.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "viewer/pictures/picture.h"

namespace gigabake {

/// Returns a PNG file's bytes: RGB if every pixel is opaque, otherwise RGBA.
/// Exact   Equal images give equal bytes.
/// Errors  std::runtime_error: libpng's message.
std::string encode_png(const Picture& picture);

/// Writes the result of encode_png(). Replaces `path` atomically.
/// Errors  InputError names the file and the system's reason. No partial file remains.
void write_png(const std::filesystem::path& path, const Picture& picture);

/// Returns a JPEG file's bytes; alpha is dropped. `quality` is 1 to 100. Below 90 the chroma channels have half the
/// resolution.
/// Exact   Equal images give equal bytes.
/// Errors  std::runtime_error: libjpeg's message.
std::string encode_jpeg(const Picture& picture, int quality);

/// Returns the error message if gigabake was built without OpenEXR; otherwise nullopt. Without OpenEXR, the functions
/// below throw std::runtime_error with this message.
std::optional<std::string> missing_openexr_error();

/// The channels of an OpenEXR file.
/// R, G, B and A are linear, premultiplied half floats. Z is a float: the distance in metres along the ray to the point
/// at which half of the light is absorbed. Z is infinite if there is no such point.
enum class ExrChannels : std::uint8_t {
  light_and_depth,  ///< R, G, B, A and Z; needs `Picture::linear`
  depth,            ///< Z
};

/// Returns an OpenEXR file's bytes, with rows from top to bottom and ZIP compression. `voxel_size_m` converts
/// `Picture::depth` to metres.
/// Exact   Equal images give equal bytes.
/// Errors  std::runtime_error: an empty image, an image without the required channels, or OpenEXR's message.
std::string encode_exr(const Picture& picture, ExrChannels channels, double voxel_size_m);

/// Writes the result of encode_exr(). Replaces `path` atomically.
/// Errors  InputError names the file and the system's reason. No partial file remains.
void write_exr(const std::filesystem::path& path, const Picture& picture, ExrChannels channels, double voxel_size_m);

}  // namespace gigabake
