#include "kernels/pool/pack_brick.h"

#include <bit>

namespace gigabake::kernels {
namespace {

bool has_layer(const SlotVoxels& slot, int z) {
  std::uint32_t any = 0;
  for (const std::uint16_t row : slot.row[z]) any |= row;
  return any != 0;
}

/// Appends the voxels of layer z to `parts` and returns the layer.
CastLayer pack_layer(const SlotVoxels& slot, int z, std::vector<PackedVoxel>& parts) {
  std::uint32_t places[3] = {0, 0, 0};
  const auto first = std::uint32_t(parts.size());
  for (int y = 0; y < slot_edge; ++y)
    for (std::uint32_t row = slot.row[z][y]; row != 0; row &= row - 1) {
      const int at = std::countr_zero(row) + slot_edge * y;
      places[at / 32] |= 1u << at % 32;
      parts.push_back(slot.voxel[at + slot_edge * slot_edge * z]);
    }
  return make_layer(places, first);
}

/// Returns CastHead::blocks. The bit of a block is set if one of the 27 voxels in and around the block exists.
std::uint64_t blocks_of(const SlotVoxels& slot) {
  std::uint64_t blocks = 0;
  for (int z = 0; z < brick_edge; z += 2)
    for (int y = 0; y < brick_edge; y += 2) {
      std::uint32_t any = 0;
      for (int i = 0; i < 9; ++i) any |= slot.row[z + i / 3][y + i % 3];
      for (int x = 0; x < brick_edge; x += 2)
        if ((any >> x & 7) != 0) blocks |= std::uint64_t(1) << block_of(x, y, z);
    }
  return blocks;
}

}  // namespace

void pack_brick(const SlotVoxels& slot, CastBrick& brick) {
  brick.head = {blocks_of(slot), 0, 0};
  for (int z = 0; z < slot_edge; ++z) brick.head.layers |= std::uint32_t(has_layer(slot, z)) << z;
  brick.parts.resize(std::size_t(std::popcount(brick.head.layers)));
  std::size_t at = 0;
  for (std::uint32_t left = brick.head.layers; left != 0; left &= left - 1) {
    const CastLayer layer = pack_layer(slot, std::countr_zero(left), brick.parts);
    brick.parts[at++] = {{layer.bits[0], layer.bits[1], layer.bits[2]}};
  }
}

}  // namespace gigabake::kernels
