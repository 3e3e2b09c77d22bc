/// Classes of voxels from the ids in an image.
#pragma once

#include <compare>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/octree/octree.h"

namespace gigabake {

/// The ids of texels, and the classes that follow from them.
/// Source  EXT_mesh_features: an id is the sum of value << 8·i over the channels.
struct TexelIds {
  static constexpr int max_channels = 3;  ///< ids are below 2^24

  std::uint8_t channel[max_channels] = {};  ///< 0 … 3: red, green, blue, alpha
  std::uint8_t channels = 1;                ///< 1 … max_channels
  std::int32_t null_id = -1;                ///< the id without a class; -1: none
  std::int32_t add = 0;                     ///< class = id + add

  /// Returns the id of a texel.
  GB_HD std::int32_t id_of(const std::uint8_t rgba[4]) const {
    std::int32_t id = 0;
    for (int i = 0; i < channels; ++i) id |= std::int32_t(rgba[channel[i]]) << (8 * i);
    return id;
  }
  /// Returns the class of a texel.
  /// Range   id + add is a class; the reader of the source checks it.
  GB_HD VoxelClass class_of(const std::uint8_t rgba[4]) const {
    const std::int32_t id = id_of(rgba);
    return id == null_id ? no_class : VoxelClass(id + add);
  }

  friend auto operator<=>(const TexelIds&, const TexelIds&) = default;
};

}  // namespace gigabake
