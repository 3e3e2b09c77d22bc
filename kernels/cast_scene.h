/// A paged scene as the ray caster borrows it: columns of cells, each an oct-tree whose levels may or may not be here.
///
/// A page is what comes and goes as one: the node table of a cell, or one level of a cell. What is not here has a null
/// pointer; a ray that needs it stops and names the page (cast.h). Coordinates are lod-0 voxels of the scene's lattice.
#pragma once

#include <cstdint>

#include "kernels/types.h"

namespace gigabake::kernels {

inline constexpr int max_cast_lods = 11;                          ///< cells of up to 8192 voxels
inline constexpr std::uint32_t no_page = 0xffffffffu;             ///< as a request: nothing is missing
inline constexpr float opaque_extinction = 12;                    ///< of coverage 255, per voxel: e^-12 is nothing
inline constexpr std::int64_t far_voxel = std::int64_t(1) << 52;  ///< beyond every scene; exact in a double

/// What a voxel adds to a ray, 65535 = 1. Premultiplied, so that voxels that are not there need no case of their own.
/// [0…2] linear RGB radiance / 2 × [3]. [3] extinction per voxel / opaque_extinction.
/// Extinction, not coverage, is what interpolates: a layer of voxels of coverage a, wherever its voxels' centres lie,
/// then lets exactly 1-a of the light behind it through. Interpolated coverage would let e^-2 through an opaque layer.
struct CastVoxel {
  std::uint16_t c[4];
};

/// Voxel (x,y,z) is bit x+8y of word z; its value is voxels[first + its rank among the set bits].
struct CastBrick {
  std::uint64_t mask[8];
  std::uint64_t before;  ///< bits 9(z-1)…: how many bits are set in the words below word z = 1…7
  std::uint64_t first;
};

enum class CastNodeKind : std::uint8_t { brick = 0, constant = 1, leaf_constant = 2 };

struct CastNode {
  std::uint32_t first_child = 0;  ///< index of the lowest stored child; the others follow
  std::uint32_t value = 0;        ///< brick in its level, or index into the cell's constants
  std::uint8_t child_mask = 0;    ///< bit x | y<<1 | z<<2
  CastNodeKind kind = CastNodeKind::brick;
};

struct CastLevel {
  const CastBrick* bricks = nullptr;
  const CastVoxel* voxels = nullptr;
};

struct CastCell {
  std::int64_t min[3] = {};              ///< x and y multiples of the cell's edge
  const CastNode* nodes = nullptr;       ///< [0] is the root
  const CastVoxel* constants = nullptr;  ///< here where the nodes are
  CastLevel level[max_cast_lods];
};

struct CastScene {
  Span<const CastCell> cells;              ///< column by column, upwards in each, without overlap
  Span<const std::uint64_t> column_key;    ///< interleaved column coordinates (x lowest bit), ascending
  Span<const std::uint32_t> column_first;  ///< columns+1: where a column's cells start
  std::int64_t column_min[2] = {};         ///< subtracted from a column's coordinates before they are interleaved
  std::int64_t column_count[2] = {};       ///< per axis; at most 2^31
  std::int32_t cell_bits = 0;              ///< a cell's edge is 2^cell_bits voxels
  std::int32_t lods = 0;
  double min[3] = {}, max[3] = {};     ///< a box around all cells
  std::uint32_t* page_used = nullptr;  ///< per page: the latest pass that looked at it
  std::uint32_t pass = 0;
};

GB_HD std::uint32_t node_page(std::uint32_t cell) { return cell * (max_cast_lods + 1); }
GB_HD std::uint32_t level_page(std::uint32_t cell, int lod) { return node_page(cell) + 1 + std::uint32_t(lod); }
GB_HD std::uint32_t cell_of_page(std::uint32_t page) { return page / (max_cast_lods + 1); }
/// -1: the node table.
GB_HD int lod_of_page(std::uint32_t page) { return int(page % (max_cast_lods + 1)) - 1; }

}  // namespace gigabake::kernels
