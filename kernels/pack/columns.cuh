/// A cell's columns on the device. The kernels find the voxels that share a value, count the values, and write the
/// columns. One warp per brick and channel applies the rules of core/codec.
#pragma once

#include <cstdint>
#include <vector>

#include "core/codec/shared_value.h"
#include "kernels/body/voxelize/window.h"
#include "kernels/cuda/mip/levels.cuh"
#include "kernels/pack/packer.h"

namespace gigabake::kernels {

inline constexpr int max_channels = 6;

/// The source of a column of values: `width` bytes per voxel, `stride` bytes apart. `bytes` is null if the level does
/// not have the channel.
struct ChannelView {
  const std::uint8_t* bytes;
  std::uint32_t stride, width;
};

/// The concatenated levels of a cell: brick b of a level is brick offset + b of the cell.
struct LevelsView {
  const std::uint64_t* mask[max_levels];
  const std::uint32_t* first[max_levels];
  const std::uint32_t* rgba[max_levels];
  std::uint32_t bricks[max_levels], offset[max_levels], voxels[max_levels];
  ChannelView channel[max_levels][max_channels];
  int levels, channels;
  std::uint32_t bricks_in_all;
};

/// Returns the view of `levels`.
/// Range   A level has at most max_channels channels.
/// Errors  std::length_error beyond max_channels or 2^32-1 bricks; std::invalid_argument if a level lacks a requested
///         channel.
LevelsView view_of(const std::vector<const DeviceLevel*>& levels,
                   const std::vector<std::vector<ChannelPlace>>& channels);

/// The results of find_shares() from which the host computes the sizes of the columns.
struct Findings {
  std::uint32_t begin[max_channels][max_levels];   ///< index of the level's first value among all levels and channels
  std::uint32_t values[max_channels][max_levels];  ///< number of values if they are shared
  std::uint32_t differ[max_channels][max_levels];  ///< 1: not all voxels are equal
  unsigned long long alphas[max_levels][256];

  ValuesStored stored(const LevelsView& levels, int channel, int lod) const;
};

/// The shared values of all bricks. The entry of channel c of brick b has index c · bricks_in_all + b.
struct FoundShares {
  DeviceArray<std::uint8_t> share;   ///< share_bytes per entry
  DeviceArray<std::uint32_t> start;  ///< index of the entry's first value
};

/// Finds the voxels that share a value. Waits for the stream.
/// Errors  CudaFailure.
FoundShares find_shares(DeviceHeap& heap, const LevelsView& levels, Findings& findings);

/// The destinations of a level's columns. Destinations of columns that are not stored are not used.
struct LevelOut {
  std::uint64_t *mask, *first;
  struct Channel {
    ValuesStored stored;
    std::uint8_t *value, *share;
    std::uint64_t* first;
    std::uint32_t begin;  ///< Findings::begin of this level and channel
  } channel[max_channels];
};

/// Writes the columns of all levels. `out` has one entry per lod.
/// Errors  CudaFailure.
void make_columns(DeviceHeap& heap, const LevelsView& levels, const FoundShares& shares,
                  const std::vector<LevelOut>& out);

/// The destinations of a node table's columns. If all nodes are bricks, the columns `kind`, `normal` and
/// `directional_coverage` are not written. They must be zero already.
struct NodesOut {
  std::uint64_t* key;
  std::uint32_t *first_child, *value;
  std::uint8_t *lod, *child_mask;
  NodeKind* kind;
  std::uint16_t* normal;
  std::uint32_t* directional_coverage;  ///< null if the channel is off
};

/// Writes the columns of a node table.
/// Errors  CudaFailure.
void make_node_columns(DeviceHeap& heap, const DeviceNodes& nodes, const NodesOut& out);

}  // namespace gigabake::kernels
