/// The rows of a level's columns, computed from voxels on demand (docs/format.md, "Differences"). A device computes the
/// same rows (kernels/pack).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/codec/packed_level.h"
#include "format/shard/columns/parent_voxels.h"

namespace gigabake {

class LevelDifferences {
 public:
  /// Borrows `level` and `above`, the next coarser level; null: the level is the coarsest. `parents` has the parent of
  /// each brick. `has_coverage` states whether the level has the column `facing`.
  /// Range   Both levels are consistent: `first` counts the bits of `mask`, and arrays have an entry per voxel.
  /// Cost    5 ns of one core per voxel. Collecting all rows takes 25 ns per voxel.
  LevelDifferences(const BrickLevel& level, const BrickLevel* above, std::vector<BrickParent> parents,
                   bool has_coverage, const ThreadPool& pool);

  std::uint64_t rows(LevelColumn column) const;
  /// Returns the number of rows before a brick: in the columns with a row per voxel, in `children` and in `facing`.
  /// Range   brick ≤ the number of bricks.
  std::array<std::uint64_t, 3> rows_before(std::size_t brick) const {
    return {level_.first[brick], first_children_[brick], first_coverage_[brick]};
  }
  /// Copies rows, starting at row `begin`, until `to` is full. Thread-safe.
  void collect(LevelColumn column, std::uint64_t begin, std::span<std::uint8_t> to) const;

 private:
  std::size_t bricks() const { return parents_.size(); }
  ParentVoxels parents_of(std::size_t brick) const { return parent_voxels(parents_[brick], above_); }
  std::uint64_t groups_with_parent_of(std::size_t brick) const { return groups_with_parent(parents_[brick], above_); }
  template <class Test>
  bool any_brick(const Test& test, const ThreadPool& pool) const;
  bool has_voxel_without_parent(std::size_t brick) const;
  bool requires_all_coverages_of(std::size_t brick) const;
  void count_rows(bool has_coverage, const ThreadPool& pool);
  std::uint32_t count_coverages(std::size_t brick) const;
  const std::uint64_t* mask_of(std::size_t brick) const { return &level_.mask[8 * brick]; }
  const std::uint8_t* coverage_of(std::size_t voxel) const {
    return &level_.directional_coverage[directional_coverage_bytes * voxel];
  }

  template <class Write>
  void collect_bricks(std::span<const std::uint64_t> first, std::size_t width, std::uint64_t begin,
                      std::span<std::uint8_t> to, const Write& write) const;
  void write_children(std::size_t brick, std::uint8_t* to) const;
  void write_colours(std::size_t brick, std::uint8_t* to) const;
  void write_normals(std::size_t brick, std::uint8_t* to) const;
  void write_coverages(std::size_t brick, std::uint8_t* to) const;
  void collect_starts(std::uint64_t begin, std::span<std::uint8_t> to) const;

  const BrickLevel& level_;
  SomeBricks above_;
  std::vector<BrickParent> parents_;
  bool is_dense_, is_complete_;  ///< is_dense of children_rows(), is_complete of stores_coverage()
  std::vector<std::uint64_t> first_children_, first_coverage_;  ///< per brick, and the number of rows
};

}  // namespace gigabake
