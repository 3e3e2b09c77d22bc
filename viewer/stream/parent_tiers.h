/// The levels above the cells as a viewer goes through them: tiers of parents, each of blocks side by side, up to one
/// root (scheduler/parents.h). Which parents there are is not said here: they stand in the scene's pages.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "format/scene/paged_scene.h"

namespace gigabake {

/// A parent's place among those of its tier: its window's lowest corner in windows.
using TierBlock = std::array<std::int64_t, 3>;

struct ParentTier {
  std::int32_t first_lod = 0, lods = 0;  ///< all levels that its parents store
  std::int32_t copied_lods = 0;          ///< of these: the finest, which children store too
  std::int32_t bits = 0;                 ///< a window's edge is 2^bits lod-0 voxels
  std::array<std::int64_t, 3> origin{};  ///< corner of block 0, 0, 0

  std::int32_t own_lod() const { return first_lod + copied_lods; }
  std::int64_t edge() const { return std::int64_t(1) << bits; }
  TierBlock block_of(const std::array<std::int64_t, 3>& v) const;
  std::array<std::int64_t, 3> corner_of(const TierBlock& block) const;
};

struct ParentTiers {
  std::vector<ParentTier> tiers;  ///< from the cells upwards; the last one is the root alone
  std::uint32_t root = 0;         ///< its index among the parents that scene.xml lists

  /// How many tiers store a level; below those that do, cells do.
  std::size_t holders(int lod) const;
  /// One of them, the largest parents first. Range  holder < holders(lod).
  const ParentTier& holder(int lod, std::size_t holder) const;
};

/// Returns nothing where not all of a scene hangs from one root (format/scene/tier_shape.h), or where that is wider
/// than rays go. An error of the bake (`max_error`) changes no voxel's existence, and parents store copies of what
/// their children store, so the levels agree. Cost  What scene.xml says. Of a scene before version 5 a look at its
/// parents, and where it says that a cell or a
///       parent is lost, at all cells too.
std::optional<ParentTiers> parent_tiers(const PagedScene& scene);

}  // namespace gigabake
