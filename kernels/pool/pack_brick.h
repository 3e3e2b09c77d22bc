/// Packing of a brick for the pools, from one row of bits per row of voxels.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "kernels/pool/cast_brick.h"
#include "kernels/pool/voxel_run.h"

namespace gigabake::kernels {

/// The voxels of a slot and the mask of existing voxels.
struct SlotVoxels {
  std::uint16_t row[slot_edge][slot_edge] = {};  ///< [z][y]; bit x is set if the voxel exists
  PackedVoxel voxel[slot_voxels];                ///< index x + 9y + 81z; valid only if the bit in `row` is set
};

/// A packed brick. The code that copies it to the voxel pool sets head.first to the index of the first part in the
/// pool.
struct CastBrick {
  CastHead head = {};
  std::uint32_t part_count = 0;                        ///< number of parts in the pool; 0 if the brick has no voxel
  std::vector<PackedVoxel> parts;                      ///< all parts, or only the layers if there are runs
  std::vector<VoxelRun> runs;                          ///< the voxels, if they are copied from pages
  std::array<PooledPage, max_brick_pages> pages = {};  ///< of `runs`
  std::int32_t lod = 0;                                ///< level of the voxels of `runs`
};

/// Bricks that are passed from thread to thread. Moving a pointer takes less time than moving a brick.
using CastBricks = std::vector<std::unique_ptr<CastBrick>>;

/// Packs a slot; replaces the contents of `brick`.
void pack_brick(const SlotVoxels& slot, CastBrick& brick);

/// Packs the layers of a slot; replaces the contents of `brick` except for its runs and their pages and level.
void pack_layers(const SlotVoxels& slot, CastBrick& brick);

}  // namespace gigabake::kernels
