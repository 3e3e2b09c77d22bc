/// Packed bricks, the output of one task, and their concatenation into a level.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"
#include "kernels/body/voxel.h"

namespace gigabake::kernels {

/// Max number of bricks of a run.
inline constexpr std::size_t bricks_per_run = 16;

/// Consecutive bricks of a level in Morton order.
class BrickRun {
 public:
  /// `planes` is true for lod-0 bricks with planes. Bricks of coarser levels ignore it.
  explicit BrickRun(bool normals = true, bool planes = false) : normals_(normals), planes_(planes) {}

  /// Appends a brick. `voxels` are in ascending order of their mask bits.
  void push_brick(std::uint64_t key, const std::uint64_t mask[8], std::span<const Voxel> voxels);
  /// Appends the directional coverage and planes of the last brick, directional_coverage_bytes per voxel. Call it for
  /// all bricks or for none.
  void push_directional_coverage(std::span<const std::uint8_t> directional_coverage) {
    if (directional_coverage_.empty()) directional_coverage_.reserve(bricks_per_run * directional_coverage.size());
    directional_coverage_.insert(directional_coverage_.end(), directional_coverage.begin(), directional_coverage.end());
  }
  /// Appends the classes of the last brick, one per voxel. Call it for all bricks or for none.
  void push_classes(std::span<const VoxelClass> classes) {
    voxel_class_.insert(voxel_class_.end(), classes.begin(), classes.end());
  }
  bool has_planes() const { return planes_; }
  std::size_t voxels() const { return rgba_.size() / 4; }
  std::size_t bricks() const { return key_.size(); }

  friend void append(Level& level, std::vector<BrickRun>& runs, const ThreadPool& pool);

 private:
  void reserve_for(std::size_t voxels_per_brick);
  void make_room(Level& level, std::size_t bricks, std::size_t voxels, bool directional_coverage, bool classes,
                 const ThreadPool& pool) const;

  bool normals_, planes_;
  std::vector<std::uint64_t> key_, mask_;
  std::vector<std::uint8_t> rgba_;
  std::vector<std::int8_t> normal_;
  std::vector<std::uint8_t> directional_coverage_;
  std::vector<VoxelClass> voxel_class_;
};

/// Moves the runs' bricks, in order, to the end of the level and empties the runs.
void append(Level& level, std::vector<BrickRun>& runs, const ThreadPool& pool);

}  // namespace gigabake::kernels
