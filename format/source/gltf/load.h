/// A checked glTF document in tinygltf's model, with images still encoded.
#pragma once

#include <filesystem>
#include <tiny_gltf.h>
#include <vector>

#include "format/source/content_container.h"

namespace gigabake {

struct GltfDocument {
  tinygltf::Model model;                        ///< without the buffers' bytes
  std::vector<SourceBytes> buffers;             ///< of the document, then those that were unpacked; what views are in
  std::vector<SourceBytes> images;              ///< encoded; empty where it cannot be used or was not requested
  std::vector<std::string> image_faults;        ///< by image: why it cannot be used; empty where it can
  std::array<double, 3> rtc_center{};           ///< b3dm's or i3dm's RTC_CENTER plus the CESIUM_RTC extension, z up
  std::vector<Affine<World, World>> instances;  ///< as ContentContainer

  /// The bytes of one of the model's views.
  SourceBytes view_bytes(int view) const;
  /// Appends a buffer and returns its number.
  int add_buffer(std::vector<std::uint8_t> bytes);
};

/// Cost  The binary chunk of a GLB that is a file of its own stays in the file; everything else is in memory.
/// Errors  InputError: everything check_gltf() finds, buffers that cannot be read, and what tinygltf refuses. An image
///         that cannot be used is no error of the document.
GltfDocument load_gltf(const TileRef& tile, const std::filesystem::path& root, bool with_images);

}  // namespace gigabake
