/// The voxels of a scene as one lattice, read through whatever pages are here.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kernels/cast/locate.h"
#include "viewer/stream/cell_layout.h"
#include "viewer/stream/pager.h"

namespace gigabake {

/// What a question could not read.
struct PageGaps {
  std::uint32_t scene_cell = rim_cell;  ///< set by who asks: the cell whose damage matters
  std::vector<PageKey> missing;         ///< not here yet, with repetitions
  bool damaged = false;                 ///< a page of that cell will never be here. Damage is taken for empty
};

/// What stands at a voxel, and the box for which that holds.
struct VoxelPlace {
  enum class Kind { nothing, brick, constant };
  Kind kind = Kind::nothing;
  kernels::VoxelBox box;
  const BrickBlock* block = nullptr;  ///< of a brick: where it is, valid until the pager's next pass
  std::size_t brick = 0;              ///< in the block
  std::array<std::uint8_t, 4> rgba{};
  std::array<std::int8_t, 2> normal{};
  Facing facing{};  ///< all three of a constant
  bool has_facing = false;
};

/// Questions may be asked from several threads at once, between two passes of the pager.
class VoxelLookup {
 public:
  /// Borrows both.
  VoxelLookup(const CellLayout& layout, const Pager& pager) : layout_(layout), pager_(pager) {}

  /// Whether any node of level `lod` reaches into the box (lod-0 voxels). Where pages are missing the answer is of no
  /// use.
  bool is_occupied(int lod, const kernels::VoxelBox& box, PageGaps& gaps) const;

  /// v: a lod-0 voxel; the answer is of the voxel of level `lod` that holds it.
  VoxelPlace place(int lod, const std::int64_t v[3], PageGaps& gaps) const;

 private:
  const NodeRow* row(std::uint32_t scene_cell, std::uint32_t index, PageGaps& gaps) const;
  bool is_occupied_below(std::uint32_t cell, std::uint32_t row_index, int level, const std::int64_t corner[3], int lod,
                         const kernels::VoxelBox& box, PageGaps& gaps) const;
  void set_content(std::uint32_t scene_cell, const NodeRow& found, int lod, PageGaps& gaps, VoxelPlace& place) const;

  const CellLayout& layout_;
  const Pager& pager_;
};

}  // namespace gigabake
