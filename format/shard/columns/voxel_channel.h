/// The channels of a voxel in shards of versions 1 to 6: for each channel, its column in the file and its position in
/// memory.
#pragma once

#include <cstdint>
#include <type_traits>
#include <vector>

#include "format/shard/hdf5/hdf5_file.h"
#include "format/shard/shard.h"

namespace gigabake {

/// The arrays of BrickLevel that have an element per voxel.
enum class VoxelArray : std::uint8_t { rgba, normal, directional_coverage };

struct VoxelChannel {
  const char* name;    ///< name of the column
  Hdf5Type type;       ///< type of one element
  std::size_t width;   ///< bytes per voxel
  VoxelArray array;    ///< array that holds the channel in memory
  std::size_t offset;  ///< first byte of the channel within a voxel's entry of the array
};

/// Returns whether a shard of format version `version` stores a plane per voxel of lattice level `lod`. Lod-0 voxels
/// have planes since version 6.
inline bool has_planes(std::int32_t version, const ShardHeader& header, int lattice_lod) {
  return version >= (lattice_lod == 0 ? 6 : 3) && header.has_directional_coverage && header.has_normals;
}

/// Returns whether the voxels of level 0 have lattice level 0 and planes.
inline bool has_finest_planes(std::int32_t version, const ShardHeader& header) {
  return header.first_lod == 0 && has_planes(version, header, 0);
}

/// Returns the channels that a shard of format version `version` stores per voxel of level `lod`.
inline std::vector<VoxelChannel> stored_channels(std::int32_t version, const ShardHeader& header, int lod) {
  std::vector<VoxelChannel> channels;
  if (version == 1)
    channels = {{"rgba", Hdf5Type::u8, 4, VoxelArray::rgba, 0}};
  else
    channels = {{"rgb", Hdf5Type::u8, 3, VoxelArray::rgba, 0}, {"alpha", Hdf5Type::u8, 1, VoxelArray::rgba, 3}};
  if (header.has_normals) channels.push_back({"normal", Hdf5Type::i8, 2, VoxelArray::normal, 0});
  const int lattice_lod = int(header.first_lod) + lod;
  if (header.has_directional_coverage && lattice_lod > 0)
    channels.push_back({"facing", Hdf5Type::u8, coverage_bytes, VoxelArray::directional_coverage, 0});
  if (has_planes(version, header, lattice_lod))
    channels.push_back({"plane", Hdf5Type::u8, 1, VoxelArray::directional_coverage, directional_coverage_plane});
  return channels;
}

/// One channel in memory: the bytes of voxel v begin at first + v·stride. Borrowed.
template <class Byte>
struct ChannelBytes {
  Byte* first;
  std::size_t stride;
  Byte* operator[](std::size_t voxel) const { return first + voxel * stride; }
};

/// Calls body(width) with a compile-time width for widths 1 to 3. Copies of a known width compile to move instructions
/// instead of calls of memcpy.
template <class Body>
void with_known_width(std::size_t width, const Body& body) {
  switch (width) {
    case 1:
      return body(std::integral_constant<std::size_t, 1>());
    case 2:
      return body(std::integral_constant<std::size_t, 2>());
    case 3:
      return body(std::integral_constant<std::size_t, 3>());
    default:
      return body(width);
  }
}

inline std::size_t bytes_a_voxel(VoxelArray array) {
  return array == VoxelArray::rgba ? 4 : array == VoxelArray::normal ? 2 : directional_coverage_bytes;
}

/// Calls use(array) with the vector that holds the channel. `Bricks` is BrickLevel or BrickBlock.
template <class Bricks, class Use>
auto with_array(const VoxelChannel& channel, Bricks& bricks, const Use& use) {
  if (channel.array == VoxelArray::rgba) return use(bricks.rgba);
  return channel.array == VoxelArray::directional_coverage ? use(bricks.directional_coverage) : use(bricks.normal);
}

/// Resizes the array that holds the channel to `voxels` entries, and returns the channel's bytes.
template <class Bricks>
ChannelBytes<std::uint8_t> resize_channel(const VoxelChannel& channel, std::size_t voxels, Bricks& bricks) {
  auto* bytes = with_array(channel, bricks, [&](auto& array) {
    array.resize(bytes_a_voxel(channel.array) * voxels);
    return reinterpret_cast<std::uint8_t*>(array.data());
  });
  return {bytes + channel.offset, bytes_a_voxel(channel.array)};
}

}  // namespace gigabake
