/// A checked glTF document in tinygltf's model, with images still encoded.
#pragma once

#include <filesystem>
#include <tiny_gltf.h>
#include <vector>

#include "format/source/content_container.h"

namespace gigabake {

struct GltfDocument {
  tinygltf::Model model;
  std::vector<std::vector<std::uint8_t>>
      images;                                   ///< encoded bytes; empty where the file is missing or was not asked for
  std::vector<char> has_image;                  ///< by image: there are bytes, asked for or not
  std::array<double, 3> rtc_center{};           ///< b3dm's or i3dm's RTC_CENTER plus the CESIUM_RTC extension, z up
  std::vector<Affine<World, World>> instances;  ///< as ContentContainer
};

/// Errors  InputError: everything check_gltf() finds, and what tinygltf refuses.
GltfDocument load_gltf(const TileRef& tile, const std::filesystem::path& root, bool with_images);

}  // namespace gigabake
