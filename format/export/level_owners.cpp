#include "format/export/level_owners.h"

#include <algorithm>
#include <bit>

namespace gigabake {
namespace {

/// Returns the level on which a cell of this edge has a single brick.
int root_lod(std::uint32_t edge_voxels) { return std::bit_width(edge_voxels / brick_edge) - 1; }

}  // namespace

LevelOwner LevelOwners::of(const SceneCell& shard) {
  return {shard, int(shard.own_lod()), int(shard.first_lod + shard.lods) - 1};
}

LevelOwners::LevelOwners(const PagedScene& scene) : scene_(scene) {
  if (scene.totals().cell_voxels != 0) {
    coarsest_ = root_lod(scene.totals().cell_voxels);
  } else {
    coarsest_ = 62;
    scene.for_each_cell([this](const SceneCell& c) { coarsest_ = std::min(coarsest_, int(c.lods) - 1); });
  }
  if (has_overviews()) coarsest_ = std::max(coarsest_, int(scene.totals().voxels.size()) - 1);
}

std::vector<LevelOwner> LevelOwners::of(int lod, const Box3i64& box) const {
  std::vector<SceneCell> shards = scene_.overviews_in(box, lod);
  if (shards.empty()) shards = scene_.cells_in(box);
  std::vector<LevelOwner> owners;
  for (const SceneCell& shard : shards) owners.push_back(of(shard));
  return owners;
}

void LevelOwners::for_each(int finest, int coarsest, std::size_t share, std::size_t shares,
                           const std::function<void(std::vector<LevelOwner>)>& visit) const {
  std::vector<LevelOwner> found;
  const auto add = [&](const SceneCell& shard) {
    const LevelOwner owner = of(shard);
    if (owner.coarsest >= finest && owner.finest <= coarsest) found.push_back(owner);
  };
  std::size_t number = 0;
  const auto add_if_own = [&](const SceneCell& shard) {
    if (number++ % shares == share) add(shard);
  };
  const std::vector<PageReference> pages = scene_.leaves(callers_thread(), [&](const ScenePage& page) {
    for (const SceneCell& overview : page.overviews) add_if_own(overview);
  });
  if (pages.empty()) scene_.for_each_cell(add_if_own);
  visit(std::move(found));
  for (std::size_t i = share; i < pages.size(); i += shares) {
    found.clear();
    const ScenePage page = read_page(scene_.file(), scene_.header(), pages[i]);
    for (const auto& shards : {&page.cells, &page.overviews})
      for (const SceneCell& shard : *shards) add(shard);
    visit(std::move(found));
  }
}

}  // namespace gigabake
