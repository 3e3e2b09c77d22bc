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
/// The last word has room for how many of them stand before the second (bits 17 to 22) and before the last word (23 to
/// 29), so that one of them is found by counting the bits of one word.
struct alignas(16) CastLayer {
  std::uint32_t bits[3];
  std::uint32_t first;
};
inline constexpr int last_places = slot_edge * slot_edge - 64;
inline constexpr std::uint32_t last_places_mask = (1u << last_places) - 1;

/// As rays read a brick: its nine layers, and the pool of voxels.
struct BrickView {
  const CastLayer* layers;
  const PackedVoxel* voxels;
};

GB_HD int ones_in(std::uint32_t bits) {
#if defined(__CUDA_ARCH__)
  return __popc(bits);
#else
  return std::popcount(bits);
#endif
}

/// places: its 81 bits alone.
GB_HD CastLayer make_layer(const std::uint32_t places[3], std::uint32_t first) {
  const auto before_second = std::uint32_t(ones_in(places[0]));
  const auto before_last = before_second + std::uint32_t(ones_in(places[1]));
  return {{places[0], places[1], places[2] | before_second << 17 | before_last << 23}, first};
}

/// A layer's voxels from one on: bit k of `bits`, up to 10, says that the voxel k places behind it is there.
struct LayerWindow {
  std::uint32_t bits;
  std::uint32_t first, second;  ///< where the first of them that is there stands, and of the next row

  GB_HD bool has(int k) const { return (bits >> k & 1) != 0; }
  /// Range  has(k); k: 0, 1, and the same of the next row.
  GB_HD std::uint32_t place(int k) const {
    const bool is_next_row = k >= slot_edge;
    const std::uint32_t row = is_next_row ? bits >> slot_edge : bits;
    return (is_next_row ? second : first) + (k == 1 || k == slot_edge + 1 ? row & 1 : 0);
  }
};

/// at: x + 9y.
GB_HD LayerWindow window_of(const CastLayer& layer, int at) {
  const int word = at / 32, bit = at % 32;
  const std::uint32_t last = layer.bits[2] & last_places_mask;
  const std::uint32_t own = word == 0 ? layer.bits[0] : word == 1 ? layer.bits[1] : last;
  const std::uint32_t next = word == 0 ? layer.bits[1] : word == 1 ? last : 0;
  const std::uint32_t before = word == 0 ? 0 : layer.bits[2] >> (word == 1 ? 17 : 23) & (word == 1 ? 63 : 127);
  const auto bits = std::uint32_t((own | std::uint64_t(next) << 32) >> bit);
  const std::uint32_t first = layer.first + before + std::uint32_t(ones_in(own & ((1u << bit) - 1)));
  return {bits, first, first + std::uint32_t(ones_in(bits & ((1u << slot_edge) - 1)))};
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
