/// Which shard of a scene holds a voxel of some level, for rays that go from place to place: cells, the parents above
/// them, and the cells that a bake lost.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "format/scene/paged_scene.h"
#include "kernels/cast/locate.h"
#include "viewer/stream/cell_layout.h"
#include "viewer/stream/parent_tiers.h"

namespace gigabake {

/// What is around a voxel, and the box for which that holds.
struct QueryPlace {
  enum class Kind { nothing, shard, lost };
  Kind kind = Kind::nothing;
  std::uint32_t shard = 0;  ///< its number, as NumberedShards counts; of a lost cell, that of lost_name()
  kernels::VoxelBox box{};
};

using LatticeCorner = std::array<std::int64_t, 3>;
struct CornerHash {
  std::size_t operator()(const LatticeCorner& corner) const;
};

/// Any number of threads may ask at once.
class QueryPlaces {
 public:
  /// Cost    Reads every page of the scene; keeps some 40 bytes a cell or parent.
  /// Errors  InputError as lay_out_cells().
  QueryPlaces(const PagedScene& scene, const ThreadPool& pool);

  /// Levels that can be asked for: those of the cells, and with parents theirs. Where a cell is lost the parents are
  /// left out, since they say nothing of it.
  int lods() const { return lods_; }
  /// Around all cells, lost ones too.
  const kernels::VoxelBox& window() const { return window_; }

  /// Range  lod < lods().
  QueryPlace find(int lod, const std::int64_t v[3]) const;

  bool is_lost(std::uint32_t shard) const { return shard >= first_lost_; }
  const std::string& lost_name(std::uint32_t shard) const { return lost_[shard - first_lost_]; }

 private:
  QueryPlace find_cell(const std::int64_t v[3]) const;
  QueryPlace find_parent(int lod, const std::int64_t v[3]) const;

  int lods_ = 0;
  kernels::VoxelBox window_{};
  CellLayout layout_;
  std::vector<std::uint32_t> number_;  ///< by cell of the layout
  std::uint32_t cells_ = 0, first_lost_ = 0;
  std::vector<std::string> lost_;
  std::optional<ParentTiers> tiers_;
  /// By their own lod and lowest corner: a parent's number.
  std::map<std::uint32_t, std::unordered_map<LatticeCorner, std::uint32_t, CornerHash>> parents_;
};

}  // namespace gigabake
