/// A checked glTF document in tinygltf's model, with images still encoded.
#pragma once

#include <filesystem>
#include <tiny_gltf.h>
#include <vector>

#include "format/source/content/content_container.h"

namespace gigabake {

struct GltfDocument {
  tinygltf::Model model;                  ///< without the buffers' bytes
  std::vector<SourceBytes> buffers;       ///< buffers of the document, then of unpacked data
  std::vector<SourceBytes> images;        ///< encoded; an unusable or unrequested image is empty
  std::vector<std::string> image_faults;  ///< per image: why it cannot be used, else empty
  std::array<double, 3> rtc_center{};     ///< b3dm's or i3dm's RTC_CENTER plus the CESIUM_RTC extension, z up
  // See ContentContainer.
  std::vector<Affine<World, World>> instances;
  std::vector<std::uint32_t> instance_ids;
  bool is_instanced = false, has_unused_instance_ids = false;

  /// Returns the bytes of a view of the model.
  SourceBytes view_bytes(int view) const;
  /// Appends a buffer and returns its number.
  int add_buffer(std::vector<std::uint8_t> bytes);
};

/// Loads a document.
/// Cost    The binary chunk of a plain .glb file in a folder is not read into memory; all other bytes are.
/// Errors  InputError: all errors of check_gltf(), and buffers that cannot be read. An image that cannot be used is no
///         error of the document.
GltfDocument load_gltf(const TileRef& tile, const std::filesystem::path& root, bool with_images);

}  // namespace gigabake
