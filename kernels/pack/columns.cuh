/// A cell's columns on the device: which voxels share a value, how many values that leaves, and then every column's
/// rows. The rules are lattice/pack's; here they are spread over warps, one for a brick and channel.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/body/window.h"
#include "kernels/cuda/levels.cuh"
#include "kernels/pack/packer.h"
#include "lattice/pack/shared_value.h"

namespace gigabake::kernels {

inline constexpr int most_channels = 6;

/// What a column of values stores of each voxel: `width` bytes, `stride` bytes apart. No bytes: the level has none.
struct ChannelView {
  const std::uint8_t* bytes;
  std::uint32_t stride, width;
};

/// All levels of a cell, one behind the other: brick b of a level is brick offset + b of the cell.
struct LevelsView {
  const std::uint64_t* mask[most_levels];
  const std::uint32_t* first[most_levels];
  const std::uint32_t* rgba[most_levels];
  std::uint32_t bricks[most_levels], offset[most_levels], voxels[most_levels];
  ChannelView channel[most_levels][most_channels];
  int levels, channels;
  std::uint32_t bricks_in_all;
};

/// Range  most_channels a level, as many for each as its levels have; std::length_error beyond 2^32-1 bricks.
LevelsView view_of(const std::vector<const DeviceLevel*>& levels,
                   const std::vector<std::vector<ChannelPlace>>& channels);

/// What the host must know before it can say how large the columns are.
struct Findings {
  std::uint32_t begin[most_channels][most_levels];   ///< of the level's values, in those of all levels and channels
  std::uint32_t values[most_channels][most_levels];  ///< if they are shared
  std::uint32_t differ[most_channels][most_levels];  ///< 1: not all voxels are alike
  unsigned long long alphas[most_levels][256];

  ValuesStored stored(const LevelsView& levels, int channel, int lod) const;
};

/// Brick b's channel c is number c · bricks_in_all + b here.
struct FoundShares {
  DeviceArray<std::uint8_t> share;   ///< share_bytes each
  DeviceArray<std::uint32_t> start;  ///< where its values begin
};

/// Waits for the stream. Errors  CudaFailure.
FoundShares find_shares(DeviceHeap& heap, const LevelsView& levels, Findings& findings);

/// Where a level's columns are to be made; of those that are not stored null.
struct LevelOut {
  std::uint64_t *mask, *first;
  struct Channel {
    ValuesStored stored;
    std::uint8_t *value, *share;
    std::uint64_t* first;
    std::uint32_t begin;  ///< as Findings::begin
  } channel[most_channels];
};

/// out: [lod]. Errors  CudaFailure.
void make_columns(DeviceHeap& heap, const LevelsView& levels, const FoundShares& shares,
                  const std::vector<LevelOut>& out);

/// Where the columns of a node table are to be made. Those of a table of bricks that are zeros are not made here.
struct NodesOut {
  std::uint64_t* key;
  std::uint32_t *first_child, *value;
  std::uint8_t *lod, *child_mask;
  NodeKind* kind;
  std::uint16_t* normal;
  std::uint32_t* facing;  ///< or null
};

/// Errors  CudaFailure.
void make_node_columns(DeviceHeap& heap, const DeviceNodes& nodes, const NodesOut& out);

}  // namespace gigabake::kernels
