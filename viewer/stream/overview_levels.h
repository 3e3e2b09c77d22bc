/// Overview levels as a viewer traverses them: each is a set of adjacent blocks, up to one root
/// (scheduler/plan/overviews.h). They do not specify which overviews exist; the scene's pages list them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/math/vec3.h"
#include "format/scene/paged_scene.h"

namespace gigabake {

/// An overview's position in its overview level: its window's lowest corner, in windows.
using OverviewBlock = Vec3i64;

struct OverviewLevel {
  std::int32_t first_lod = 0, lods = 0;  ///< all levels that its overviews store
  std::int32_t copied_lods = 0;          ///< number of its finest levels that children store too
  std::int32_t bits = 0;                 ///< a window's edge is 2^bits lod-0 voxels
  Vec3i64 origin{};                      ///< corner of block (0, 0, 0)

  std::int32_t own_lod() const { return first_lod + copied_lods; }
  std::int64_t edge() const { return std::int64_t(1) << bits; }
  OverviewBlock block_of(const Vec3i64& v) const;
  Vec3i64 corner_of(const OverviewBlock& block) const;
};

struct OverviewLevels {
  std::vector<OverviewLevel> levels;  ///< bottom-up; the last one contains only the root
  std::uint32_t root = 0;             ///< its index among the overviews that scene.xml lists

  /// Returns how many overview levels store the level; cells that store it are not counted.
  std::size_t holders(int lod) const;
  /// Returns one of the overview levels that store the level; number 0 has the largest overviews.
  /// Range   `holder` < holders(lod).
  const OverviewLevel& holder(int lod, std::size_t holder) const;
};

/// Returns nullopt if not all of a scene has one common root (format/scene/tier_shape.h), or if the root is too wide
/// for rays. A level is equal in all overviews that store it. The reason is that `max_error` of the bake changes no
/// voxel's existence, and overviews store copies of their children's levels.
/// Cost    Reads only scene.xml. Scenes before version 5: also their overviews, and all cells if scene.xml names a
///         missing cell or overview.
std::optional<OverviewLevels> overview_levels(const PagedScene& scene);

}  // namespace gigabake
