/// Bytes and coverage of one level of a cell or of a scene. All members are sums, so summaries of cells can be added.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/shard/shard.h"

namespace gigabake {

struct LevelSummary {
  /// Number of voxels with an alpha of 1 … 63, 64 … 127, 128 … 191, 192 … 254, and 255. The bins add up to all voxels
  /// of the level.
  static constexpr std::size_t bins = 5;
  std::array<std::uint64_t, bins> coverage{};
  std::uint64_t alpha_sum = 0;     ///< sum of the stored 8-bit alphas
  std::uint64_t stored_bytes = 0;  ///< size of the level's columns on disk, compressed, without HDF5's metadata

  std::uint64_t voxels() const;
  double mean_coverage() const;  ///< 0 … 1; 0 if there are no voxels
  LevelSummary& operator+=(const LevelSummary& other);
  friend bool operator==(const LevelSummary&, const LevelSummary&) = default;
};

/// Returns the summary per lod; stored_bytes is 0. Counts constant nodes as the voxels that they represent.
/// Cost    One pass over the alphas, 1 ns of one core per voxel.
std::vector<LevelSummary> summarize_levels(const Shard& shard, const ThreadPool& pool = callers_thread());

/// Number of voxels per alpha value in the bricks of one level.
using AlphaCounts = std::array<std::uint64_t, 256>;

/// Returns the summary per lod of a shard that has `nodes` and, per lod, bricks with these alpha counts.
std::vector<LevelSummary> summarize_levels(const std::vector<AlphaCounts>& alphas, const NodeTable& nodes);

/// Adds `of` to `to` per lod, extending `to` if needed. Level 0 of `of` is level `first_lod` of `to`. Skips the first
/// `copied` levels of `of`, which an overview duplicates from its children.
void add_levels(const std::vector<LevelSummary>& of, std::size_t first_lod, std::size_t copied,
                std::vector<LevelSummary>& to);

}  // namespace gigabake
