/// What one level of a cell, or of a scene, amounts to: bytes and coverage. Sums, so that cells add up.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/shard/shard.h"

namespace gigabake {

struct LevelSummary {
  /// How many voxels have an alpha of 1 … 63, 64 … 127, 128 … 191, 192 … 254, and 255; all voxels of the level
  /// together.
  static constexpr std::size_t bins = 5;
  std::array<std::uint64_t, bins> coverage{};
  std::uint64_t alpha_sum = 0;     ///< of the stored 8-bit alphas
  std::uint64_t stored_bytes = 0;  ///< of the level's columns on disk, compressed, without HDF5's own index

  std::uint64_t voxels() const;
  double mean_coverage() const;  ///< 0 … 1; 0 where there are no voxels
  LevelSummary& operator+=(const LevelSummary& other);
  friend bool operator==(const LevelSummary&, const LevelSummary&) = default;
};

/// Per lod, without stored_bytes. What constant nodes stand for counts as if it were written out.
/// Cost    One pass over the alphas, a nanosecond of a core a voxel.
std::vector<LevelSummary> summarize_levels(const Shard& shard, const ThreadPool& pool = callers_thread());

/// How many bricks' voxels of a level have each alpha.
using AlphaCounts = std::array<std::uint64_t, 256>;

/// The same of counts per lod that somebody else has made.
std::vector<LevelSummary> summarize_levels(const std::vector<AlphaCounts>& alphas, const NodeTable& nodes);

/// Per lod, up to the highest that either has. first_lod: of `of`, the first so many of which are copies and do not
/// count.
void add_levels(const std::vector<LevelSummary>& of, std::size_t first_lod, std::size_t copied,
                std::vector<LevelSummary>& to);

}  // namespace gigabake
