/// Packing of a brick for the pools, from one row of bits per row of voxels.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/pool/cast_brick.h"

namespace gigabake::kernels {

/// The voxels of a slot and the mask of existing voxels.
struct SlotVoxels {
  std::uint16_t row[slot_edge][slot_edge] = {};  ///< [z][y], x in the lowest bit
  PackedVoxel voxel[slot_voxels];                ///< x fastest; valid where `row` has a bit
};

/// A brick for a slot. The caster sets head.first to the place of the first part in the voxel pool.
struct CastBrick {
  CastHead head = {};
  std::vector<PackedVoxel> parts;  ///< empty if the brick has no voxel
};

/// Packs a slot; replaces the contents of `brick`.
void pack_brick(const SlotVoxels& slot, CastBrick& brick);

}  // namespace gigabake::kernels
