/// The level at which each part of a cell is stored, if its parts have several levels (PartView::lod).
///
/// A brick of level k is *refined* if a triangle of level k or less, or an edit, occupies it, or if a brick below it is
/// refined. Surface in a refined brick of level k is voxelized at level k or less. Octants of refined bricks that are
/// not refined themselves become leaves: their voxels describe all finer levels.
///
/// Exact   The set of refined bricks depends only on the triangles that occupy it and on the edits, not on the window,
///         if the window's corner is a multiple of 4 · 2^k voxels for the coarsest level k of the parts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"
#include "kernels/body/voxelize/brick_triangle.h"
#include "kernels/body/voxelize/triangle_bricks.h"
#include "kernels/cpu/voxelize/brick_set.h"

namespace gigabake::kernels {

/// Returns the coarsest level of the input's parts; 0 if all are voxelized at lod 0.
int coarsest_lod(const CellInput& input);

/// Returns the parameters of the same cell with level `lod` in place of lod 0. Its edits and kept voxels are not set.
CellParameters at_level(const CellParameters& parameters, int lod);

class StoredDepth {
 public:
  /// Finds the refined bricks. `triangles` are the cell's triangles in sub-voxels of lod 0, and must outlive the
  /// object.
  StoredDepth(const CellInput& input, std::span<const WindowTriangle> triangles, const CellParameters& parameters,
              const ThreadPool& pool);

  int coarsest() const { return int(refined_.size()) - 1; }
  /// Returns the triangles of level `lod` and coarser, in sub-voxels of that level.
  std::span<const WindowTriangle> triangles(int lod) const { return triangles_[std::size_t(lod)]; }
  /// Calls visit(key) for the bricks of level `lod` in which `triangle` of triangles(lod) is voxelized at that level.
  template <class Visit>
  void for_each_brick(const WindowTriangle& triangle, int lod, const Visit& visit) const {
    const CellWindow& window = windows_[std::size_t(lod)];
    if (lod_of_part_[triangle.part] == lod) {  // most triangles; all bricks that it occupies are refined
      const BrickSet& refined = refined_[std::size_t(lod)];
      return kernels::for_each_brick(triangle, window, [&](std::uint64_t key) {
        if (refined.contains(key) && !is_wholly_refined(key, lod)) visit(key);
      });
    }
    BrickBox box;
    if (!brick_box(triangle, window.rule, window.bricks, box)) return;
    descend(triangle, box, is_narrow(triangle), {0, 0, 0}, window.levels, lod, visit);
  }
  /// Returns the voxels of a brick of level `lod` that are voxelized at that level: voxels of octants that are not
  /// refined.
  VoxelMask own_voxels(std::uint64_t key, int lod) const;
  std::uint64_t bytes() const;

 private:
  void add_occupied(int lod, const ThreadPool& pool);
  bool is_wholly_refined(std::uint64_t key, int lod) const {
    return lod > 0 && refined_[std::size_t(lod) - 1].children(key) == 255;
  }
  template <class Visit>
  void descend(const WindowTriangle& t, const BrickBox& box, bool narrow, const Vec3<std::int32_t>& node, int above,
               int lod, const Visit& visit) const;

  std::vector<int> lod_of_part_;
  std::vector<CellWindow> windows_;                         ///< [lod]
  std::vector<std::vector<WindowTriangle>> of_level_;       ///< [lod - 1]
  std::vector<std::span<const WindowTriangle>> triangles_;  ///< [lod]
  std::vector<BrickSet> refined_;                           ///< [lod]
};

/// Visits the bricks below a node that the triangle may touch. `above` is the node's level above `lod`.
template <class Visit>
void StoredDepth::descend(const WindowTriangle& t, const BrickBox& box, bool narrow, const Vec3<std::int32_t>& node,
                          int above, int lod, const Visit& visit) const {
  const std::uint64_t key = morton(std::uint32_t(node[0]), std::uint32_t(node[1]), std::uint32_t(node[2]));
  if (lod + above <= coarsest() && !refined_[std::size_t(lod + above)].contains(key)) return;
  if (!may_touch_node(t, box, narrow, node, above)) return;
  if (above == 0) {
    if (!is_wholly_refined(key, lod)) visit(key);
    return;
  }
  for (int child = 0; child < 8; ++child)
    descend(t, box, narrow, node * 2 + Vec3<std::int32_t>{child & 1, child >> 1 & 1, child >> 2}, above - 1, lod,
            visit);
}

}  // namespace gigabake::kernels
