/// The overview levels of a scene, as a viewer traverses them. The windows of a level are adjacent blocks of equal
/// size, up to one root (scheduler/plan/overviews.h). A level does not state which of its overviews exist; the scene's
/// pages list them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/math/vec3.h"
#include "format/scene/paged_scene.h"

namespace gigabake {

/// The position of an overview in its overview level, in units of the level's window edge.
using OverviewBlock = Vec3i64;

struct OverviewLevel {
  std::int32_t first_lod = 0, lods = 0;  ///< levels that the overviews store
  std::int32_t copied_lods = 0;          ///< number of the finest levels that children store too
  std::int32_t bits = 0;                 ///< a window's edge is 2^bits lod-0 voxels
  Vec3i64 origin{};                      ///< corner of block (0, 0, 0), lod-0 voxels

  std::int32_t own_lod() const { return first_lod + copied_lods; }
  std::int64_t edge() const { return std::int64_t(1) << bits; }
  OverviewBlock block_of(const Vec3i64& v) const;
  Vec3i64 corner_of(const OverviewBlock& block) const;
  friend bool operator==(const OverviewLevel&, const OverviewLevel&) = default;
};

struct OverviewLevels {
  std::vector<OverviewLevel> levels;  ///< bottom-up; the last overview level contains only the root
  std::uint32_t root = 0;             ///< index of the root among the overviews that scene.xml lists

  /// Returns the number of overview levels that store level `lod`; cells that store it are not counted.
  std::size_t holders(int lod) const;
  /// Returns one of the overview levels that store level `lod`; `provider` 0 has the largest overviews.
  /// Range   `provider` < holders(lod).
  const OverviewLevel& provider(int lod, std::size_t provider) const;
};

/// Returns the overview levels of a scene. Returns nullopt if the scene has no common root (format/scene/tier_shape.h),
/// or if the root is too wide for rays.
/// A level has the same voxels in all overviews that store it. The reason is that `max_error` of the bake does not
/// change which voxels exist, and overviews store copies of their children's levels.
/// Cost    Reads only scene.xml. For scenes before version 5, also reads their overviews. For these scenes, reads all
///         cells if scene.xml names a missing cell or overview.
std::optional<OverviewLevels> overview_levels(const PagedScene& scene);

}  // namespace gigabake
