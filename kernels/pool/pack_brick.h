/// Packing of a brick for the pools, from one row of bits per row of voxels.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/pool/cast_brick.h"

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
  std::vector<PackedVoxel> parts;  ///< empty if the brick has no voxel
};

/// Packs a slot; replaces the contents of `brick`.
void pack_brick(const SlotVoxels& slot, CastBrick& brick);

}  // namespace gigabake::kernels
