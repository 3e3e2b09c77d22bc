/// A paged scene as the ray caster borrows it: columns of cells, each an oct-tree whose nodes and bricks stand in two
/// pools of fixed size (kernels/cast/cast_brick.h) and may or may not be here. A cell here is the root of a tree: one
/// that was baked by itself, or a part of a scene that hangs from its parents (viewer/stream/cell_layout.h).
///
/// The trees here are of *fields*, not of voxels: a voxel's field reaches from its centre to its neighbours' centres,
/// so a node holds what lies between the centre of its lowest voxel and one voxel beyond its highest. It exists where
/// it or one of its seven upper neighbours has a voxel, and its brick carries their lowest layers as a border. Then a
/// point needs one brick, and what is empty is empty to its rim.
///
/// Coordinates are lod-0 voxels of the scene's lattice.
/// Source  Crassin et al. 2009, "GigaVoxels" (node pool, brick pool, borders, rays that ask for what they miss).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "kernels/cast/cast_brick.h"
#include "kernels/cast/cast_node.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

inline constexpr int max_cast_lods = 29;                          ///< of a tree of up to 2^31 voxels along an edge
inline constexpr std::int64_t far_voxel = std::int64_t(1) << 52;  ///< beyond every scene; exact in a double

/// Exact: its bits are put together. A product with it is exact too, so it replaces divisions by an edge's length.
/// Range   -1000 … 1000.
GB_HD double power_of_two(int exponent) { return std::bit_cast<double>(std::uint64_t(1023 + exponent) << 52); }

struct CastCell {
  std::int64_t min[3] = {};  ///< x and y multiples of the cell's edge. The root of cell c is node c
};

/// What rays tell whoever fills the pools. Stamps: `pass` where it happened in this pass.
struct CastMarks {
  std::uint32_t* tile_used = nullptr;  ///< by tile: rays ended their descent in it
  std::uint32_t* slot_used = nullptr;
  std::uint32_t* wanted = nullptr;  ///< bit 2·node + Want, 32 a word: a ray of this pass misses that
};
enum class Want : std::uint32_t { brick = 0, children = 1 };

struct CastScene {
  Span<const CastCell> cells;              ///< column by column, upwards in each, without overlap
  Span<const std::uint64_t> column_key;    ///< interleaved column coordinates (x lowest bit), ascending
  Span<const std::uint32_t> column_first;  ///< columns+1: where a column's cells start
  std::int64_t column_min[2] = {};         ///< subtracted from a column's coordinates before they are interleaved
  std::int64_t column_count[2] = {};       ///< per axis; below 2^31
  std::int32_t cell_bits = 0;              ///< a cell's edge is 2^cell_bits voxels
  std::int32_t lods = 0;
  double min[3] = {}, max[3] = {};  ///< a box around all voxels
  std::int64_t corner[3] = {};      ///< from where points are counted (kernels/cast/fixed_point.h): set_corner()

  const NodeWord* nodes = nullptr;
  const std::uint32_t* parent_bricks = nullptr;  ///< by tile: the brick of the node whose children it holds
  const CastHead* heads = nullptr;               ///< by slot
  const PackedVoxel* voxels = nullptr;
  CastMarks marks;
  std::uint32_t pass = 0;

  /// Below all that rays look at, and on the lattice of columns. Range  min, lods and cell_bits are set.
  void set_corner() {
    for (int a = 0; a < 3; ++a)
      corner[a] = ((std::int64_t(min[a]) - (std::int64_t(4) << lods)) >> cell_bits) * (std::int64_t(1) << cell_bits);
  }

  GB_HD CastNode node_of(NodeWord word) const {
    return leads_on(word) ? CastNode{word, parent_bricks[word]} : unpack_leaf(word);
  }
  GB_HD BrickView brick(const CastHead& head) const { return {head.layers, voxels + head.first}; }
  GB_HD BrickView brick(std::uint32_t slot) const { return brick(load_head(heads + slot)); }
};

}  // namespace gigabake::kernels
