/// A brick of the pools: a mask of the existing voxels among its 9³ places, and these voxels, packed contiguously.
///
/// The places are the brick's own 8³ voxels and the adjacent layers of its upper neighbours. Bricks at surfaces are
/// mostly empty, so only existing voxels take memory. A bit mask per layer yields the index of each voxel.
/// Source  Crassin et al. 2009, "GigaVoxels" (bricks with borders); ranks of bits as in Kämpe, Sintorn, Assarsson 2013,
///         "High Resolution Sparse Voxel DAGs".
#pragma once

#include <bit>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/octree/brick.h"
#include "kernels/pool/packed_voxel.h"

namespace gigabake::kernels {

inline constexpr int slot_edge = brick_edge + 1, slot_voxels = slot_edge * slot_edge * slot_edge;

/// The header of a brick. There is one header per slot of the pool. The parts of the brick are stored in the voxel pool
/// from index `first` on. The first parts are the layers that have voxels, in ascending z; a layer takes the memory of
/// one voxel. The other parts are the voxels, layer by layer.
struct alignas(16) CastHead {
  /// The mask of the 4×4×4 blocks in which the interpolated field is not zero. Block (x, y, z) extends from the centre
  /// of voxel 2(x, y, z) to the centre of voxel 2(x, y, z) + 2. Bit x + 4y + 16z is set if one of the 27 voxels in this
  /// range exists.
  std::uint64_t blocks;
  std::uint32_t first;
  std::uint32_t layers;  ///< bit z: the layer has voxels
};

/// The voxels of a brick with the same z. Bit x + 9y of `bits` is set if the voxel exists; voxels are stored in this
/// order. The last word also has an index, from bit 17 on. It is the index of the first voxel whose bit is not in the
/// first word. The index is relative to the brick's first part.
struct CastLayer {
  std::uint32_t bits[3];
};
static_assert(sizeof(CastLayer) == sizeof(PackedVoxel));
inline constexpr int last_places = slot_edge * slot_edge - 64;
inline constexpr std::uint32_t last_places_mask = (1u << last_places) - 1;
inline constexpr int max_parts = slot_edge + slot_voxels;
static_assert(max_parts < 1 << (32 - last_places));

/// A brick for reading: the mask of its layers, and the voxel pool, in which its parts begin at index `first`. Indices
/// of parts have 32 bits, because a device adds 64-bit indices in several instructions.
struct BrickView {
  std::uint32_t layers, first;
  const PackedVoxel* voxels;
};

/// Returns the index of the lowest set bit.
/// Range   bits ≠ 0.
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

/// Packs a layer. `places` has the layer's 81 bits; the other bits are 0. `first` is the index of the layer's first
/// voxel, relative to the brick's first part.
GB_HD CastLayer make_layer(const std::uint32_t places[3], std::uint32_t first) {
  return {{places[0], places[1], places[2] | (first + std::uint32_t(ones_in(places[0]))) << last_places}};
}

/// Returns the bit number in CastHead::blocks of the block that contains point (x, y, z), in voxels from the first
/// centre.
GB_HD int block_of(int x, int y, int z) { return x / 2 + 4 * (y / 2) + 16 * (z / 2); }

/// Returns true if the interpolated field is zero in the point's block.
GB_HD bool is_empty_block(std::uint64_t blocks, const int point[3]) {
  return (blocks >> block_of(point[0], point[1], point[2]) & 1) == 0;
}

/// The existing voxels of a layer from one voxel on, which is voxel 0 of the window. Bit k of `bits`, k ≤ 10, is set if
/// voxel k exists. Voxel slot_edge is the neighbour of voxel 0 in the next row.
struct LayerWindow {
  std::uint32_t bits;
  std::uint32_t first, second;  ///< part indices of the first existing voxels from voxels 0 and slot_edge on

  GB_HD bool has(int k) const { return (bits >> k & 1) != 0; }
  /// Returns four bits: for voxels 0 and 1, then for voxels slot_edge and slot_edge + 1.
  GB_HD std::uint32_t two_by_two() const { return (bits & 3) | (bits >> (slot_edge - 2) & 12); }
};

/// Returns the window that begins at voxel `at` = x + 9y.
GB_HD LayerWindow window_of(const CastLayer& layer, int at) {
#if defined(__CUDA_ARCH__)
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
#else
  const std::uint64_t low = layer.bits[0] | std::uint64_t(layer.bits[1]) << 32, last = layer.bits[2] & last_places_mask;
  std::uint32_t first = (layer.bits[2] >> last_places) - std::uint32_t(ones_in(layer.bits[0]));
  std::uint64_t bits = last >> (at & 63), before = low;
  if (at < 64) {
    bits = low >> at | last << 1 << (63 - at);
    before = low & ((std::uint64_t(1) << at) - 1);
  } else {
    first += std::uint32_t(std::popcount(last & ((std::uint64_t(1) << (at - 64)) - 1)));
  }
  first += std::uint32_t(std::popcount(before));
  return {std::uint32_t(bits), first, first + std::uint32_t(ones_in(std::uint32_t(bits) & ((1u << slot_edge) - 1)))};
#endif
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

/// Returns the index of layer z in the voxel pool.
/// Range   The brick has the layer.
GB_HD std::uint32_t layer_index(const BrickView& brick, int z) {
  return brick.first + std::uint32_t(ones_in(brick.layers & ((1u << z) - 1)));
}

GB_HD CastLayer load_layer(const BrickView& brick, int z) {
  if ((brick.layers >> z & 1) == 0) return {};
  const PackedVoxel part = load_packed(brick.voxels + layer_index(brick, z));
  return {{part.word[0], part.word[1], part.word[2]}};
}

/// Returns the window of layer z that begins at voxel `at` = x + 9y. Its indices are indices of the voxel pool.
GB_HD LayerWindow load_window(const BrickView& brick, int z, int at) {
  LayerWindow window = window_of(load_layer(brick, z), at);
  window.first += brick.first;
  window.second += brick.first;
  return window;
}

/// Returns LayerWindow::two_by_two() of layer z from voxel `at` on, without the indices of the voxels.
GB_HD std::uint32_t load_two_by_two(const BrickView& brick, int z, int at) {
  if ((brick.layers >> z & 1) == 0) return 0;
  const std::uint32_t* const words = brick.voxels[layer_index(brick, z)].word;
  const int word = at / 32, next = word < 2 ? word + 1 : 2;
#if defined(__CUDA_ARCH__)
  const std::uint32_t bits = __funnelshift_r(__ldg(words + word), __ldg(words + next), std::uint32_t(at));
#else
  const auto bits = std::uint32_t((words[word] | std::uint64_t(words[next]) << 32) >> at % 32);
#endif
  return LayerWindow{bits, 0, 0}.two_by_two();
}

/// Returns the voxel's coverage in a view along the axis, or 0 if the voxel does not exist. The value 65535 represents
/// 1.
/// Range   x, y and z are 0 … 8.
GB_HD int coverage_at(const BrickView& brick, int x, int y, int z, int axis) {
  const LayerWindow window = load_window(brick, z, x + slot_edge * y);
  return window.has(0) ? coverage_along(load_packed(brick.voxels + window.first), axis) : 0;
}

}  // namespace gigabake::kernels
