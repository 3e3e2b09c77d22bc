#include "viewer/stream/parent_tiers.h"

#include <algorithm>

#include "format/scene/tier_shape.h"
#include "kernels/marching/scene.h"

namespace gigabake {
namespace {

/// Returns the shapes of the overview levels. Scenes before version 5, and scenes in memory, do not store them. The
/// shapes are then derived from the overviews, which scene.xml lists completely.
std::vector<TierShape> shapes_of(const PagedScene& scene) {
  if (!scene.header().tiers.empty() || scene.root().parents.size() != scene.totals().parents)
    return scene.header().tiers;
  return tiers_of(scene.root().parents, scene.header(), scene.totals().cell_voxels,
                  [&scene](const auto& visit) { scene.for_each_cell(visit); });
}

bool are_within_reach(const ParentTier& top) {
  return top.first_lod + top.lods <= kernels::max_cast_lods && std::ranges::all_of(top.origin, [](std::int64_t v) {
           return v >= -kernels::far_voxel / 4 && v <= kernels::far_voxel / 4;
         });
}

}  // namespace

TierBlock ParentTier::block_of(const std::array<std::int64_t, 3>& v) const {
  return {(v[0] - origin[0]) >> bits, (v[1] - origin[1]) >> bits, (v[2] - origin[2]) >> bits};
}

std::array<std::int64_t, 3> ParentTier::corner_of(const TierBlock& block) const {
  return {origin[0] + block[0] * edge(), origin[1] + block[1] * edge(), origin[2] + block[2] * edge()};
}

std::size_t ParentTiers::holders(int lod) const {
  return std::size_t(std::count_if(tiers.begin(), tiers.end(), [lod](const ParentTier& tier) {
    return tier.first_lod <= lod && lod < tier.first_lod + tier.lods;
  }));
}

const ParentTier& ParentTiers::holder(int lod, std::size_t holder) const {
  std::size_t t = tiers.size() - 1;
  while (tiers[t].first_lod > lod) --t;
  return tiers[t - holder];
}

std::optional<ParentTiers> parent_tiers(const PagedScene& scene) {
  if (scene.totals().parents == 0) return {};
  ParentTiers all;
  for (const TierShape& shape : shapes_of(scene))
    all.tiers.push_back({std::int32_t(shape.first_lod),
                         std::int32_t(shape.lods),
                         std::int32_t(shape.copied_lods),
                         shape.window_bits(),
                         {}});
  if (all.tiers.empty()) return {};
  ParentTier& top = all.tiers.back();
  const auto root = std::ranges::find(scene.root().parents, std::uint32_t(top.own_lod()), &SceneCell::own_lod);
  all.root = std::uint32_t(root - scene.root().parents.begin());
  top.origin = root->lattice_min;
  if (!are_within_reach(top)) return {};
  return all;
}

}  // namespace gigabake
