/// A level's columns, made by whoever has its voxels, on their way to whoever writes them (docs/format.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lattice/pack/shared_value.h"

namespace gigabake {

/// The arrays of BrickLevel that have something of each voxel.
enum class VoxelArray : std::uint8_t { rgba, normal, facing };

/// Where in memory a voxel has what one column stores of it.
struct ChannelPlace {
  VoxelArray array;
  std::size_t stride;         ///< from voxel to voxel, bytes
  std::size_t offset, width;  ///< of a voxel's bytes; width ≤ widest_value
};

/// A row of each of a level's columns: its bytes, and of how many bytes are the elements whose byte planes are stored
/// one behind the other (1: it is stored as it is). Columns of values: as wide as their channel, as they are.
struct RowShape {
  std::size_t bytes, shuffled_bytes;
};
inline constexpr RowShape mask_row{64, 1}, first_row{8, 8}, share_row{share_bytes, 1};

/// Where the columns of a node table stand in a file. From `normal` on they say something of constant nodes alone, as
/// `kind` does; `facing` is there where the channel is.
enum class NodeColumn : std::uint8_t { key, lod, kind, child_mask, first_child, value, normal, facing };

/// A column's bytes. Borrowed. At most one of the two has any.
struct PackedColumn {
  std::uint64_t rows = 0;
  std::span<const std::uint8_t> raw = {};  ///< of all rows
  /// Chunk after chunk as they are stored: shuffled, compressed, with their checksums.
  std::vector<std::span<const std::uint8_t>> stored = {};
};

/// share and first have rows where values are shared.
struct PackedChannel {
  PackedColumn value, share, first;
};

struct PackedLevel {
  PackedColumn mask, first;
  std::vector<PackedChannel> channels;         ///< in the order of those that were asked for
  std::array<std::uint64_t, 256> alphas = {};  ///< how many voxels have each alpha
};

}  // namespace gigabake
