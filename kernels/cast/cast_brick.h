/// A brick of the pools: which of its 9³ voxels are there, and these, packed one after another.
///
/// Its own 8³ voxels and the lowest layers of its upper neighbours. Most of what bricks of surfaces hold is not there,
/// so a brick takes as much as it has voxels: a layer says by its bits where each of them stands.
/// Source  Crassin et al. 2009, "GigaVoxels" (bricks with borders); ranks of bits as in Kämpe, Sintorn, Assarsson 2013,
///         "High Resolution Sparse Voxel DAGs".
#pragma once

#include <bit>
#include <cstdint>

#include "kernels/cast/packed_voxel.h"
#include "lattice/brick.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

inline constexpr int slot_edge = brick_edge + 1, slot_voxels = slot_edge * slot_edge * slot_edge;

/// Bit x + 8y of word z: the field is not zero everywhere between the centres of voxels (x,y,z) and (x,y,z) + 1.
struct CastMask {
  std::uint64_t word[8];
};

/// Of one z: bit x + 9y of `bits` says that a voxel is there; they stand in the pool from `first` on, in that order.
struct alignas(16) CastLayer {
  std::uint32_t bits[3];
  std::uint32_t first;
};

/// As rays read a brick: its nine layers, and the pool of voxels.
struct BrickView {
  const CastLayer* layers;
  const PackedVoxel* voxels;
};

GB_HD int ones_in(std::uint64_t bits) {
#if defined(__CUDA_ARCH__)
  return __popcll(bits);
#else
  return std::popcount(bits);
#endif
}

/// A layer's voxels from one on: bit k of `bits`, up to 10, says that the voxel k places behind it is there.
struct LayerWindow {
  std::uint32_t bits;
  std::uint32_t first;  ///< where the first of them that is there stands

  GB_HD bool has(int k) const { return (bits >> k & 1) != 0; }
  /// Range  has(k).
  GB_HD std::uint32_t place(int k) const { return first + std::uint32_t(ones_in(bits & ((1u << k) - 1))); }
};

/// at: x + 9y.
GB_HD LayerWindow window_of(const CastLayer& layer, int at) {
  const std::uint64_t low = layer.bits[0] | std::uint64_t(layer.bits[1]) << 32, high = layer.bits[2];
  if (at >= 64) {
    const std::uint64_t before = high & ((std::uint64_t(1) << (at - 64)) - 1);
    return {std::uint32_t(high >> (at - 64)), layer.first + std::uint32_t(ones_in(low) + ones_in(before))};
  }
  const std::uint64_t before = low & ((std::uint64_t(1) << at) - 1);
  return {std::uint32_t(low >> at | (high << 1) << (63 - at)), layer.first + std::uint32_t(ones_in(before))};
}

GB_HD CastLayer load_layer(const CastLayer* at) {
#if defined(__CUDA_ARCH__)
  const uint4 words = __ldg(reinterpret_cast<const uint4*>(at));
  return {{words.x, words.y, words.z}, words.w};
#else
  return *at;
#endif
}

GB_HD PackedVoxel load_packed(const PackedVoxel* at) {
#if defined(__CUDA_ARCH__)
  return {{__ldg(at->word), __ldg(at->word + 1), __ldg(at->word + 2)}};
#else
  return *at;
#endif
}

/// What a view along the axis sees of the voxel, 65535 = 1; 0 where it is not there. x, y, z: 0 … 8.
GB_HD int coverage_at(const BrickView& brick, int x, int y, int z, int axis) {
  const LayerWindow window = window_of(load_layer(brick.layers + z), x + slot_edge * y);
  return window.has(0) ? coverage_along(load_packed(brick.voxels + window.first), axis) : 0;
}

}  // namespace gigabake::kernels
