/// Packing a brick for the pools: from a row of bits for each row of its voxels to parts.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/cast/cast_brick.h"

namespace gigabake::kernels {

/// The voxels of a slot, and which of them are there.
struct SlotVoxels {
  std::uint16_t row[slot_edge][slot_edge] = {};  ///< [z][y], x the lowest bit
  PackedVoxel voxel[slot_voxels];                ///< x fastest; those that `row` says are there
};

/// A brick to put into a slot, where head.first becomes the place of its first part.
struct CastBrick {
  CastHead head = {};
  std::vector<PackedVoxel> parts;  ///< none: no voxel is there
};

/// brick: what it held is replaced.
void pack_brick(const SlotVoxels& slot, CastBrick& brick);

}  // namespace gigabake::kernels
