/// The channels of a voxel: as which column each is stored, and where it stands in memory. Whoever adds one adds it
/// here and to BrickLevel and BrickBlock; writing, reading, paging and sharing go channel by channel.
#pragma once

#include <cstdint>
#include <type_traits>
#include <vector>

#include "format/shard/hdf5/hdf5_file.h"
#include "format/shard/shard.h"
#include "lattice/pack/packed_level.h"

namespace gigabake {

struct VoxelChannel {
  const char* name;    ///< of its column
  Hdf5Type type;       ///< of one byte
  std::size_t width;   ///< bytes of a voxel
  VoxelArray array;    ///< in memory,
  std::size_t offset;  ///< from this byte of a voxel on
};

/// Whether shards of that version say where a voxel's sheet lies, along its normal. Where they do not, there is none.
inline bool has_planes(std::int32_t version, const ShardHeader& header) {
  return version >= 3 && header.has_facing && header.has_normals;
}

/// What a shard of that version stores of each voxel of a level of its own.
inline std::vector<VoxelChannel> stored_channels(std::int32_t version, const ShardHeader& header, int lod) {
  std::vector<VoxelChannel> channels;
  if (version == 1)
    channels = {{"rgba", Hdf5Type::u8, 4, VoxelArray::rgba, 0}};
  else
    channels = {{"rgb", Hdf5Type::u8, 3, VoxelArray::rgba, 0}, {"alpha", Hdf5Type::u8, 1, VoxelArray::rgba, 3}};
  if (header.has_normals) channels.push_back({"normal", Hdf5Type::i8, 2, VoxelArray::normal, 0});
  if (header.has_facing && int(header.first_lod) + lod > 0) {
    channels.push_back({"facing", Hdf5Type::u8, coverage_bytes, VoxelArray::facing, 0});
    if (has_planes(version, header)) channels.push_back({"plane", Hdf5Type::u8, 1, VoxelArray::facing, facing_plane});
  }
  return channels;
}

/// One channel in memory: voxel v's bytes begin at first + v·stride. Borrowed.
template <class Byte>
struct ChannelBytes {
  Byte* first;
  std::size_t stride;
  Byte* operator[](std::size_t voxel) const { return first + voxel * stride; }
};

/// body(width) with a width that the compiler knows, for those that there are: copies of 1 to 4 bytes are instructions
/// then, not calls.
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
  return array == VoxelArray::rgba ? 4 : array == VoxelArray::normal ? 2 : facing_bytes;
}

/// Calls use(array) with the vector in which the channel stands. Bricks: BrickLevel or BrickBlock.
template <class Bricks, class Use>
auto with_array(const VoxelChannel& channel, Bricks& bricks, const Use& use) {
  if (channel.array == VoxelArray::rgba) return use(bricks.rgba);
  return channel.array == VoxelArray::facing ? use(bricks.facing) : use(bricks.normal);
}

template <class Bricks>
std::size_t array_bytes(const VoxelChannel& channel, const Bricks& bricks) {
  return with_array(channel, bricks, [](const auto& array) { return array.size(); });
}

template <class Bricks>
ChannelBytes<const std::uint8_t> bytes_of(const VoxelChannel& channel, const Bricks& bricks) {
  const auto* bytes = with_array(channel, bricks,
                                 [](const auto& array) { return reinterpret_cast<const std::uint8_t*>(array.data()); });
  return {bytes + channel.offset, bytes_a_voxel(channel.array)};
}

/// With room for so many voxels.
template <class Bricks>
ChannelBytes<std::uint8_t> make_room(const VoxelChannel& channel, std::size_t voxels, Bricks& bricks) {
  auto* bytes = with_array(channel, bricks, [&](auto& array) {
    array.resize(bytes_a_voxel(channel.array) * voxels);
    return reinterpret_cast<std::uint8_t*>(array.data());
  });
  return {bytes + channel.offset, bytes_a_voxel(channel.array)};
}

}  // namespace gigabake
