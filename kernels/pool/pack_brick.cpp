#include "kernels/pool/pack_brick.h"

#include <bit>

namespace gigabake::kernels {
namespace {

/// Returns the layer of row bits `row`, whose first voxel has index `first`, and adds the number of its voxels to
/// `first`.
CastLayer pack_layer(const std::uint16_t row[slot_edge], std::uint32_t& first) {
  std::uint64_t low = 0, high = 0;
  for (int y = 0; y < slot_edge; ++y) {
    const std::uint64_t bits = row[y];
    const int at = slot_edge * y;
    if (at < 64) low |= bits << at;
    if (at + slot_edge > 64) high |= at < 64 ? bits >> (64 - at) : bits << (at - 64);
  }
  const std::uint32_t places[3] = {std::uint32_t(low), std::uint32_t(low >> 32), std::uint32_t(high)};
  const CastLayer layer = make_layer(places, first);
  first += std::uint32_t(std::popcount(low) + std::popcount(high));
  return layer;
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

void pack_layers(const SlotVoxels& slot, CastBrick& brick) {
  brick.head = {blocks_of(slot), 0, 0};
  for (int z = 0; z < slot_edge; ++z) {
    std::uint32_t any = 0;
    for (const std::uint16_t row : slot.row[z]) any |= row;
    brick.head.layers |= std::uint32_t(any != 0) << z;
  }
  brick.parts.resize(std::size_t(std::popcount(brick.head.layers)));
  brick.part_count = std::uint32_t(brick.parts.size());
  std::size_t at = 0;
  for (std::uint32_t left = brick.head.layers; left != 0; left &= left - 1) {
    const CastLayer layer = pack_layer(slot.row[std::countr_zero(left)], brick.part_count);
    brick.parts[at++] = {{layer.bits[0], layer.bits[1], layer.bits[2]}};
  }
}

void pack_brick(const SlotVoxels& slot, CastBrick& brick) {
  brick.runs.clear();
  pack_layers(slot, brick);
  brick.parts.reserve(brick.part_count);
  for (std::uint32_t left = brick.head.layers; left != 0; left &= left - 1) {
    const int z = std::countr_zero(left);
    for (int y = 0; y < slot_edge; ++y)
      for (std::uint32_t row = slot.row[z][y]; row != 0; row &= row - 1)
        brick.parts.push_back(slot.voxel[std::countr_zero(row) + slot_edge * (y + slot_edge * z)]);
  }
}

}  // namespace gigabake::kernels
