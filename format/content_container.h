/// The outer layers of a content file: b3dm around GLB around JSON and a binary chunk.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "format/source.h"
#include "format/source_file.h"

namespace gigabake {

struct ContentContainer {
  std::vector<std::uint8_t> file;      ///< owns what the spans look at
  std::span<const std::uint8_t> gltf;  ///< a whole GLB, or glTF JSON
  std::span<const std::uint8_t> json;  ///< the JSON text within
  std::span<const std::uint8_t> bin;   ///< the GLB's binary chunk; empty without one
  bool is_binary = false;
  std::array<double, 3> rtc_center{};  ///< of a b3dm's feature table, in the tile's z-up frame
};

/// Errors  InputError with the byte where a length, version or magic number is wrong.
ContentContainer open_container(const TileRef& tile);

}  // namespace gigabake
