/// A level's columns, packed by a kernel or the host for the writer of the shard (docs/format.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/codec/shared_value.h"

namespace gigabake {

/// The arrays of BrickLevel that have an element per voxel.
enum class VoxelArray : std::uint8_t { rgba, normal, directional_coverage };

/// The location of a column's values in a voxel array.
struct ChannelPlace {
  VoxelArray array;
  std::size_t stride;         ///< bytes from voxel to voxel
  std::size_t offset, width;  ///< bytes within a voxel; width ≤ max_value_bytes
};

/// The size of a column's rows, and the element size of HDF5's shuffle filter (1: not shuffled). Columns of values have
/// rows of the channel's width and are not shuffled.
struct RowShape {
  std::size_t bytes, shuffled_bytes;
};
inline constexpr RowShape mask_row{64, 1}, first_row{8, 8}, share_row{share_bytes, 1};

/// The columns of a node table in file order, each with one row per node. Rows of `normal` and `directional_coverage`
/// are zero for nodes that are not constant. The column `directional_coverage` exists only if the shard has that
/// channel.
enum class NodeColumn : std::uint8_t { key, lod, kind, child_mask, first_child, value, normal, directional_coverage };

/// A column's bytes, borrowed. At most one of `raw` and `stored` is not empty.
struct PackedColumn {
  std::uint64_t rows = 0;
  std::span<const std::uint8_t> raw = {};  ///< the bytes of all rows
  /// The chunks in storage format: shuffled, compressed, with checksums.
  std::vector<std::span<const std::uint8_t>> stored = {};
};

/// The columns of a channel. `share` and `first` have rows only if values are shared.
struct PackedChannel {
  PackedColumn value, share, first;
};

struct PackedLevel {
  PackedColumn mask, first;
  std::vector<PackedChannel> channels;         ///< in the order in which the channels were requested
  std::array<std::uint64_t, 256> alphas = {};  ///< number of voxels with each alpha
};

}  // namespace gigabake
