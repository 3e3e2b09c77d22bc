/// The edits of one cell, applied to its voxels of lod 0.
///
/// Exact   An edit selects voxels by their centres (format/edit/edits_in_scene.h). Edits apply in their order. A carved
///         voxel is removed. A filled voxel gets the edit's colour, alpha 255, and a normal and a plane by
///         fill_surface.h. A painted voxel, if it exists, gets the edit's colour; if the edit states an alpha, also
///         this alpha, and no plane if it is below 255. If the edit states a class, painted and filled voxels get it;
///         otherwise painted voxels keep their class, and filled voxels have none. Both backends run this code.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/base/thread_pool.h"
#include "format/edit/edits_in_scene.h"
#include "kernels/body/cell.h"

namespace gigabake {

class CellEdits {
 public:
  /// Finds the edits that select a voxel of the cell whose window `parameters` describe. Omits the first `applied` of
  /// them, which the voxels have already.
  CellEdits(const EditsInScene& edits, const kernels::CellParameters& parameters, const ThreadPool& pool,
            std::size_t applied = 0);

  bool empty() const { return edits_.empty(); }
  std::size_t size() const { return edits_.size(); }
  /// Returns the keys of the blocks of bricks, by their first brick, in which an edit may select a voxel, ascending.
  std::vector<std::uint64_t> first_bricks() const;
  /// Returns the functions for the kernels. They refer to this object.
  kernels::LevelEdits functions() const;

 private:
  /// A block of bricks, and the edits that may select voxels of it.
  struct Block {
    std::uint64_t first_brick = 0;  ///< key of its first brick
    std::vector<std::uint32_t> edits;
  };

  void apply(kernels::Level& level, std::uint64_t first, std::uint64_t end) const;
  std::uint64_t filled_voxels(std::uint64_t first, std::uint64_t end) const;
  void for_each_selected(const std::function<void(std::uint64_t key)>& visit) const;
  /// Lists the blocks that contain keys in [first, end), in Morton order.
  std::vector<Block> blocks_in(std::uint64_t first, std::uint64_t end) const;
  void add_blocks(std::uint64_t node, std::int64_t edge, std::uint64_t first, std::uint64_t end,
                  const std::vector<std::uint32_t>& candidates, std::vector<Block>& out) const;
  Vec3i64 lowest_voxel(std::uint64_t brick) const;
  kernels::Level edited(const Block& block, const kernels::Level& level) const;

  const EditsInScene& in_scene_;
  const kernels::CellParameters parameters_;
  const ThreadPool& pool_;
  std::vector<std::uint32_t> edits_;
};

}  // namespace gigabake
