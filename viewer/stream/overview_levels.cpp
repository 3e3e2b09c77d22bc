#include "viewer/stream/overview_levels.h"

#include <algorithm>

#include "format/scene/tier_shape.h"
#include "kernels/marching/scene.h"

namespace gigabake {
namespace {

/// Returns the shapes of the overview levels. Scenes before version 5, and scenes in memory, do not store them. The
/// shapes are then derived from the overviews, which scene.xml lists completely.
std::vector<TierShape> shapes_of(const PagedScene& scene) {
  if (!scene.header().tiers.empty() || scene.root().overviews.size() != scene.totals().overviews)
    return scene.header().tiers;
  return tiers_of(scene.root().overviews, scene.header(), scene.totals().cell_voxels,
                  [&scene](const auto& visit) { scene.for_each_cell(visit); });
}

bool are_within_reach(const OverviewLevel& top) {
  return top.first_lod + top.lods <= kernels::max_cast_lods && std::ranges::all_of(top.origin, [](std::int64_t v) {
           return v >= -kernels::far_voxel / 4 && v <= kernels::far_voxel / 4;
         });
}

}  // namespace

OverviewBlock OverviewLevel::block_of(const Vec3i64& v) const { return (v - origin) >> bits; }

Vec3i64 OverviewLevel::corner_of(const OverviewBlock& block) const { return origin + block * edge(); }

std::size_t OverviewLevels::holders(int lod) const {
  return std::size_t(std::count_if(levels.begin(), levels.end(), [lod](const OverviewLevel& level) {
    return level.first_lod <= lod && lod < level.first_lod + level.lods;
  }));
}

const OverviewLevel& OverviewLevels::provider(int lod, std::size_t provider) const {
  std::size_t t = levels.size() - 1;
  while (levels[t].first_lod > lod) --t;
  return levels[t - provider];
}

std::optional<OverviewLevels> overview_levels(const PagedScene& scene) {
  if (scene.totals().overviews == 0) return {};
  OverviewLevels all;
  for (const TierShape& shape : shapes_of(scene))
    all.levels.push_back({std::int32_t(shape.first_lod),
                          std::int32_t(shape.lods),
                          std::int32_t(shape.copied_lods),
                          shape.window_bits(),
                          {}});
  if (all.levels.empty()) return {};
  OverviewLevel& top = all.levels.back();
  const auto root = std::ranges::find(scene.root().overviews, std::uint32_t(top.own_lod()), &SceneCell::own_lod);
  all.root = std::uint32_t(root - scene.root().overviews.begin());
  top.origin = root->lattice_min;
  if (!are_within_reach(top)) return {};
  return all;
}

}  // namespace gigabake
