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

/// What is found of a brick by its slot. Its parts stand in the pool of voxels from `first` on: its layers, upwards,
/// each in the place of a voxel, but those alone that hold voxels; then its voxels, layer by layer.
struct alignas(16) CastHead {
  /// Where the field is zero, by blocks of 2×2×2 points. Bit x + 4y + 16z: it is not zero everywhere between the
  /// centres of voxels 2(x,y,z) and 2(x,y,z) + 2, since one of these 27 is there.
  std::uint64_t blocks;
  std::uint32_t first;
  std::uint32_t layers;  ///< bit z: voxels of that z are there
};

/// Of one z: bit x + 9y of `bits` says that a voxel is there; they stand in that order. The last word has room for
/// where the first one stands that does not belong to the first word (from bit 17 on; counted from the brick's first
/// part).
struct CastLayer {
  std::uint32_t bits[3];
};
static_assert(sizeof(CastLayer) == sizeof(PackedVoxel));
inline constexpr int last_places = slot_edge * slot_edge - 64;
inline constexpr std::uint32_t last_places_mask = (1u << last_places) - 1;
inline constexpr int most_parts = slot_edge + slot_voxels;
static_assert(most_parts < 1 << (32 - last_places));

/// As rays read a brick: which layers it has, and its parts.
struct BrickView {
  std::uint32_t layers;
  const PackedVoxel* parts;
};

/// Range  bits ≠ 0.
GB_HD int lowest_one(std::uint32_t bits) {
#if defined(__CUDA_ARCH__)
  return __ffs(int(bits)) - 1;
#else
  return std::countr_zero(bits);
#endif
}

GB_HD int ones_in(std::uint32_t bits) {
#if defined(__CUDA_ARCH__)
  return __popc(bits);
#else
  return std::popcount(bits);
#endif
}

/// places: its 81 bits alone. first: where its first voxel stands, counted from the brick's first part on.
GB_HD CastLayer make_layer(const std::uint32_t places[3], std::uint32_t first) {
  return {{places[0], places[1], places[2] | (first + std::uint32_t(ones_in(places[0]))) << last_places}};
}

/// The bit of the block of points that holds point x, y, z.
GB_HD int block_of(int x, int y, int z) { return x / 2 + 4 * (y / 2) + 16 * (z / 2); }

/// Whether the field is zero in the block of this point.
GB_HD bool is_empty_block(std::uint64_t blocks, const int point[3]) {
  return (blocks >> block_of(point[0], point[1], point[2]) & 1) == 0;
}

/// A layer's voxels from one on: bit k of `bits`, up to 10, says that the voxel k places behind it is there.
struct LayerWindow {
  std::uint32_t bits;
  std::uint32_t first, second;  ///< the part that is the first of them that is there, and of the next row

  GB_HD bool has(int k) const { return (bits >> k & 1) != 0; }
  /// Bits of voxels 0 and 1, and of these two of the next row.
  GB_HD std::uint32_t two_by_two() const { return (bits & 3) | (bits >> (slot_edge - 2) & 12); }
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
  const std::uint32_t last = layer.bits[2] & last_places_mask, second = layer.bits[1];
  const std::uint32_t own = word == 0 ? layer.bits[0] : word == 1 ? second : last;
  const std::uint32_t next = word == 0 ? second : word == 1 ? last : 0;
  const auto bits = std::uint32_t((own | std::uint64_t(next) << 32) >> bit);
  const std::uint32_t behind_first_word = layer.bits[2] >> last_places;
  const int since =
      word == 0 ? -ones_in(own >> bit) : ones_in(own & ((1u << bit) - 1)) + (word == 1 ? 0 : ones_in(second));
  const std::uint32_t first = behind_first_word + std::uint32_t(since);
  return {bits, first, first + std::uint32_t(ones_in(bits & ((1u << slot_edge) - 1)))};
}

GB_HD CastHead load_head(const CastHead* at) {
#if defined(__CUDA_ARCH__)
  const uint4 words = __ldg(reinterpret_cast<const uint4*>(at));
  return {words.x | std::uint64_t(words.y) << 32, words.z, words.w};
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

GB_HD CastLayer load_layer(const BrickView& brick, int z) {
  if ((brick.layers >> z & 1) == 0) return {};
  const PackedVoxel part = load_packed(brick.parts + ones_in(brick.layers & ((1u << z) - 1)));
  return {{part.word[0], part.word[1], part.word[2]}};
}

/// What a view along the axis sees of the voxel, 65535 = 1; 0 where it is not there. x, y, z: 0 … 8.
GB_HD int coverage_at(const BrickView& brick, int x, int y, int z, int axis) {
  const LayerWindow window = window_of(load_layer(brick, z), x + slot_edge * y);
  return window.has(0) ? coverage_along(load_packed(brick.parts + window.first), axis) : 0;
}

}  // namespace gigabake::kernels
