/// The paged scene that the ray caster borrows: columns of cells, each cell with one octree. Two pools of fixed size
/// (kernels/pool/cast_brick.h) hold the resident nodes and bricks. A cell of this layout is either a baked cell, or a
/// cube of the size of the root overview (viewer/stream/cell_layout.h).
///
/// The trees subdivide the interpolated *field*, not the voxels. A voxel contributes to the field from its centre to
/// the centres of its neighbours. A node therefore covers the space from the centre of its lowest voxel to one voxel
/// beyond the centre of its highest voxel. A node exists if it or one of its seven upper neighbours has a voxel. Its
/// brick repeats the lowest layers of these neighbours as a border. Interpolation at a point therefore reads only one
/// brick, and the field is zero everywhere in an empty node.
///
/// Coordinates are lod-0 voxels of the scene's lattice.
/// Source  Crassin et al. 2009, "GigaVoxels" (node pool, brick pool, borders, rays that request missing data).
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/marching/cast_camera.h"
#include "kernels/marching/cast_node.h"
#include "kernels/marching/voxel_space.h"
#include "kernels/pool/cast_brick.h"

namespace gigabake::kernels {

inline constexpr int max_cast_lods = 29;  ///< levels of a tree of up to 2^31 voxels along an edge

struct CastCell {
  Vec3i64 min{};  ///< lowest voxel; x and y are multiples of the cell's edge. Node c is the root of cell c
};

/// Usage feedback that rays write for the owner of the pools. An entry of tile_used or slot_used is the number of the
/// last pass that used the tile or slot.
struct UsageFeedback {
  std::uint32_t* tile_used = nullptr;  ///< by tile: last pass in which a ray's descent ended in the tile
  std::uint32_t* slot_used = nullptr;
  /// The bitmap of missed data, 32 bits per word. A ray of this pass sets bit 2·node + Want if the data that
  /// `RequestKind` names is missing in the node.
  std::uint32_t* requested = nullptr;
};
enum class RequestKind : std::uint32_t { brick = 0, children = 1 };

struct CastScene {
  Span<const CastCell> cells;              ///< ordered by column, upwards in each column, without overlap
  Span<const std::uint64_t> column_key;    ///< Morton codes of the column coordinates (x in the lowest bit), ascending
  Span<const std::uint32_t> column_first;  ///< index of each column's first cell; has columns + 1 entries
  std::int64_t column_min[2] = {};         ///< subtracted from a column's coordinates before they are interleaved
  std::int64_t column_count[2] = {};       ///< per axis; below 2^31
  std::int32_t cell_bits = 0;              ///< a cell's edge is 2^cell_bits voxels
  std::int32_t lods = 0;
  bool has_leaves = false;  ///< some octants have only coarser voxels, whose bricks replace the octants'
  Vec3d min{}, max{};       ///< a box around all voxels
  Vec3i64 corner{};         ///< origin of fixed-point coordinates (kernels/marching/fixed_point.h); see set_corner()

  bool is_lit = false;  ///< the voxels' radiance contains `light`, whose irradiance depends on the normal
  CastLight light;

  const NodeWord* nodes = nullptr;
  const std::uint32_t* parent_bricks = nullptr;  ///< by tile: the brick of the node whose children the tile holds
  const CastHead* heads = nullptr;               ///< by slot
  const PackedVoxel* voxels = nullptr;
  UsageFeedback feedback;
  std::uint32_t pass = 0;

  /// Sets `corner` to a point below all points that rays sample, aligned to cells.
  /// Range   min, lods and cell_bits are already set.
  void set_corner() {
    for (int a = 0; a < 3; ++a)
      corner[a] = ((std::int64_t(min[a]) - (std::int64_t(4) << lods)) >> cell_bits) * (std::int64_t(1) << cell_bits);
  }

  GB_HD CastNode node_of(NodeWord word) const {
    return leads_on(word) ? CastNode{word, parent_bricks[word]} : unpack_leaf(word);
  }
  GB_HD BrickView brick(const CastHead& head) const { return {head.layers, head.first, voxels}; }
  GB_HD BrickView brick(std::uint32_t slot) const { return brick(load_head(heads + slot)); }
};

}  // namespace gigabake::kernels
