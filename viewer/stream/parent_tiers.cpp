#include "viewer/stream/parent_tiers.h"

#include <algorithm>
#include <bit>
#include <map>

#include "kernels/cast/scene.h"
#include "lattice/brick.h"
#include "lattice/parameters.h"

namespace gigabake {
namespace {

/// A window of 2^bits voxels with all its levels; 0 where it is none.
int window_bits(const SceneCell& parent) {
  const std::uint32_t edge = parent.cell_voxels;
  if (!std::has_single_bit(edge) || parent.lods == 0) return 0;
  const int bits = std::countr_zero(edge);
  return bits == int(parent.first_lod + parent.lods) + 2 ? bits : 0;
}

bool add(const SceneCell& parent, std::uint32_t index, ParentTier& tier) {
  if (window_bits(parent) != tier.bits || std::int32_t(parent.lods) != tier.lods ||
      std::int32_t(parent.copied_lods) != tier.copied_lods)
    return false;
  const TierBlock block = tier.block_of(parent.lattice_min);
  return tier.corner_of(block) == parent.lattice_min && tier.parent.emplace(block, index).second;
}

/// Tiers by their first level, with the parents in them; the root's begins at its own corner.
std::optional<std::vector<ParentTier>> sorted_into_tiers(const std::vector<SceneCell>& parents) {
  const SceneCell& root = *std::max_element(
      parents.begin(), parents.end(), [](const SceneCell& a, const SceneCell& b) { return a.own_lod() < b.own_lod(); });
  std::map<std::uint32_t, ParentTier> by_lod;
  for (std::uint32_t i = 0; i < parents.size(); ++i) {
    const SceneCell& parent = parents[i];
    ParentTier& tier = by_lod[parent.own_lod()];
    if (tier.lods == 0) {
      tier.first_lod = std::int32_t(parent.first_lod);
      tier.lods = std::int32_t(parent.lods);
      tier.copied_lods = std::int32_t(parent.copied_lods);
      tier.bits = window_bits(parent);
      if (parent.own_lod() == root.own_lod()) tier.origin = root.lattice_min;
    }
    if (tier.bits == 0 || !add(parent, i, tier)) return {};
  }
  std::vector<ParentTier> tiers;
  for (auto& [lod, tier] : by_lod) tiers.push_back(std::move(tier));
  return tiers;
}

bool hang_from_one_root(const std::vector<ParentTier>& tiers, const std::vector<SceneCell>& parents) {
  for (std::size_t t = 0; t + 1 < tiers.size(); ++t) {
    const ParentTier& above = tiers[t + 1];
    if (tiers[t].first_lod + tiers[t].lods != above.own_lod() || tiers[t].first_lod > above.first_lod) return false;
    for (const auto& [block, index] : tiers[t].parent)
      if (!above.parent.contains(above.block_of(parents[index].lattice_min))) return false;
  }
  const ParentTier& top = tiers.back();
  const std::int64_t half = std::int64_t(1) << (top.bits - 1);
  return top.parent.size() == 1 && top.first_lod + top.lods <= kernels::max_cast_lods &&
         std::all_of(top.origin.begin(), top.origin.end(), [&](std::int64_t v) {
           return v % half == 0 && v >= -kernels::far_voxel / 4 && v <= kernels::far_voxel / 4;
         });
}

/// Where a cell or a parent is lost, so may be parents that nobody names: all that waited for it.
bool may_lack_parents(const SceneHeader& scene) {
  return std::any_of(scene.losses.begin(), scene.losses.end(), [](const SceneLoss& loss) {
    return loss.name.starts_with("parent ") || loss.name.starts_with("cell ");
  });
}

/// Whether all cells have parents. A cell may reach into the block above its own.
bool hold_all_cells(const ParentTier& tier, const PagedScene& scene) {
  bool all = true;
  scene.for_each_cell([&](const SceneCell& cell) {
    std::array<std::int64_t, 3> high = cell.lattice_min;
    high[2] += cell.cell_voxels - 1;
    all = all && tier.parent.contains(tier.block_of(cell.lattice_min)) && tier.parent.contains(tier.block_of(high));
  });
  return all;
}

}  // namespace

std::size_t TierBlockHash::operator()(const TierBlock& block) const {
  std::uint64_t hash = 0;
  for (const std::int64_t c : block) hash = (hash ^ std::uint64_t(c)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
  return hash;
}

TierBlock ParentTier::block_of(const std::array<std::int64_t, 3>& v) const {
  return {(v[0] - origin[0]) >> bits, (v[1] - origin[1]) >> bits, (v[2] - origin[2]) >> bits};
}

std::array<std::int64_t, 3> ParentTier::corner_of(const TierBlock& block) const {
  const std::int64_t edge = std::int64_t(1) << bits;
  return {origin[0] + block[0] * edge, origin[1] + block[1] * edge, origin[2] + block[2] * edge};
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
  const SceneHeader& header = scene.header();
  if (header.parents.empty() || parameters_from_json(header.parameters).max_error != 0) return {};
  auto tiers = sorted_into_tiers(header.parents);
  if (!tiers || !hang_from_one_root(*tiers, header.parents)) return {};
  const int cell_lods = std::bit_width(scene.totals().cell_voxels / brick_edge);
  if (cell_lods == 0 || cell_lods != tiers->front().own_lod()) return {};
  const std::uint32_t root = tiers->back().parent.begin()->second;
  if (may_lack_parents(header) && !hold_all_cells(tiers->front(), scene)) return {};
  return ParentTiers{std::move(*tiers), root};
}

}  // namespace gigabake
