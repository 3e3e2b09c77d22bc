/// A voxel as levels store it, and its bytes packed into words.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/octree/octree.h"

namespace gigabake::kernels {

struct Voxel {
  std::uint8_t rgba[4];   ///< sRGB, coverage
  std::int8_t normal[2];  ///< octahedral
};

/// Packs the four bytes as a little-endian machine reads them: red becomes the lowest byte.
GB_HD std::uint32_t pack_rgba(const std::uint8_t rgba[4]) {
  return std::uint32_t(rgba[0]) | std::uint32_t(rgba[1]) << 8 | std::uint32_t(rgba[2]) << 16 |
         std::uint32_t(rgba[3]) << 24;
}

/// Packs the two bytes; the first becomes the lowest byte. The result is also the index into Tables::unit_normal.
GB_HD std::uint16_t pack_normal(const std::int8_t normal[2]) {
  return std::uint16_t(std::uint8_t(normal[0]) | std::uint8_t(normal[1]) << 8);
}

/// Packs the directional coverage; the x axis becomes the lowest byte.
GB_HD std::uint32_t pack_directional_coverage(const std::uint8_t directional_coverage[directional_coverage_bytes]) {
  return std::uint32_t(directional_coverage[0]) | std::uint32_t(directional_coverage[1]) << 8 |
         std::uint32_t(directional_coverage[2]) << 16 | std::uint32_t(directional_coverage[3]) << 24;
}

/// Returns byte `number`; 0 is the lowest.
GB_HD std::uint8_t byte_of(std::uint32_t word, int number) { return std::uint8_t(word >> 8 * number); }

GB_HD Voxel unpack_voxel(std::uint32_t rgba, std::uint16_t normal) {
  return {{byte_of(rgba, 0), byte_of(rgba, 1), byte_of(rgba, 2), byte_of(rgba, 3)},
          {std::int8_t(byte_of(normal, 0)), std::int8_t(byte_of(normal, 1))}};
}

}  // namespace gigabake::kernels
