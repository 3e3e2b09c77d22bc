#include "viewer/query/query_places.h"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "lattice/error.h"
#include "viewer/query/lost_cells.h"

namespace gigabake {
namespace {

using kernels::VoxelBox;

VoxelBox window_box(const std::array<std::int64_t, 3>& min, std::int64_t edge) {
  VoxelBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.min[a] = min[a];
    box.max[a] = min[a] + edge;
  }
  return box;
}

}  // namespace

std::size_t CornerHash::operator()(const LatticeCorner& corner) const {
  std::uint64_t hash = 0;
  for (const std::int64_t c : corner) hash = (hash ^ std::uint64_t(c)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
  return hash;
}

QueryPlaces::QueryPlaces(const PagedScene& scene, const ThreadPool& pool) {
  std::vector<SceneCell> cells = scene.cells(pool);
  cells_ = std::uint32_t(cells.size());
  first_lost_ = cells_ + std::uint32_t(scene.totals().parents);
  if (!cells.empty())
    for (SceneCell& cell : lost_cells(scene.header(), cells)) {
      lost_.push_back(cell.name);
      cells.push_back(std::move(cell));
    }
  layout_ = lay_out_cells(cells, scene.file());
  std::unordered_map<LatticeCorner, std::uint32_t, CornerHash> number_at;
  for (std::uint32_t i = 0; i < cells.size(); ++i)
    number_at.emplace(cells[i].lattice_min, i < cells_ ? i : first_lost_ + (i - cells_));
  for (const kernels::CastCell& cell : layout_.cells) {
    const auto found = number_at.find({cell.min[0], cell.min[1], cell.min[2]});
    number_.push_back(found == number_at.end() ? kernels::no_cell : found->second);
  }
  if (lost_.empty()) tiers_ = parent_tiers(scene);
  if (tiers_)
    scene.for_each_parent([this, next = cells_](const SceneCell& parent) mutable {
      parents_[parent.own_lod()].emplace(parent.lattice_min, next++);
    });
  lods_ = tiers_ ? tiers_->tiers.back().first_lod + tiers_->tiers.back().lods : layout_.scene.lods;
  for (int a = 0; a < 3; ++a) {
    window_.min[a] = std::int64_t(layout_.scene.min[a]);
    window_.max[a] = std::int64_t(layout_.scene.max[a]);
  }
}

QueryPlace QueryPlaces::find_cell(const std::int64_t v[3]) const {
  QueryPlace place;
  std::uint32_t cell = 0;
  if (!kernels::find_cell(layout_.scene, v, cell, place.box)) return place;
  const kernels::CastCell& found = layout_.cells[cell];
  place.box = window_box({found.min[0], found.min[1], found.min[2]}, std::int64_t(1) << layout_.scene.cell_bits);
  if (number_[cell] == kernels::no_cell) return place;
  place.shard = number_[cell];
  place.kind = is_lost(place.shard) ? QueryPlace::Kind::lost : QueryPlace::Kind::shard;
  return place;
}

QueryPlace QueryPlaces::find_parent(int lod, const std::int64_t v[3]) const {
  const ParentTier& tier = tiers_->holder(lod, tiers_->holders(lod) - 1);  // those that the level is of
  const TierBlock block = tier.block_of({v[0], v[1], v[2]});
  QueryPlace place;
  place.box = window_box(tier.corner_of(block), std::int64_t(1) << tier.bits);
  const auto parents = parents_.find(std::uint32_t(tier.own_lod()));
  if (parents == parents_.end()) return place;
  const auto found = parents->second.find(tier.corner_of(block));
  if (found == parents->second.end()) return place;
  place.shard = found->second;
  place.kind = QueryPlace::Kind::shard;
  return place;
}

QueryPlace QueryPlaces::find(int lod, const std::int64_t v[3]) const {
  return lod < layout_.scene.lods ? find_cell(v) : find_parent(lod, v);
}

}  // namespace gigabake
