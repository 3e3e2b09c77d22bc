#include "format/export/level_owners.h"

#include <algorithm>
#include <bit>

namespace gigabake {
namespace {

/// The level of which a cell of that edge has one brick.
int root_lod(std::uint32_t edge_voxels) { return std::bit_width(edge_voxels / brick_edge) - 1; }

}  // namespace

LevelOwner LevelOwners::of_cell(const SceneCell& cell) { return {cell, 0, int(cell.lods) - 1}; }

LevelOwners::LevelOwners(const PagedScene& scene) : scene_(scene) {
  if (scene.totals().cell_voxels != 0) {
    coarsest_ = root_lod(scene.totals().cell_voxels);
  } else {
    coarsest_ = 62;
    scene.for_each_cell([this](const SceneCell& c) { coarsest_ = std::min(coarsest_, int(c.lods) - 1); });
  }
  for (const SceneCell& parent : scene.header().parents) {
    parents_.push_back({parent, int(parent.own_lod()), int(parent.first_lod + parent.lods) - 1});
    coarsest_ = std::max(coarsest_, parents_.back().coarsest);
  }
}

std::vector<LevelOwner> LevelOwners::of(int lod, const LatticeBox& box) const {
  std::vector<LevelOwner> owners;
  const auto add = [&](const LevelOwner& owner) {
    if (owner.finest <= lod && lod <= owner.coarsest && !intersection(window_of(owner.shard), box).is_empty())
      owners.push_back(owner);
  };
  for (const LevelOwner& parent : parents_) add(parent);
  if (owners.empty())
    for (const SceneCell& cell : scene_.cells_in(box)) add(of_cell(cell));
  return owners;
}

void LevelOwners::for_each(int finest, int coarsest, std::size_t share, std::size_t shares,
                           const std::function<void(std::vector<LevelOwner>)>& visit) const {
  std::size_t number = 0;
  std::vector<LevelOwner> found;
  const auto add = [&](const LevelOwner& owner) {
    if (owner.coarsest >= finest && owner.finest <= coarsest && number++ % shares == share) found.push_back(owner);
  };
  for (const LevelOwner& parent : parents_) add(parent);
  const std::vector<PageReference> pages = scene_.leaves();
  if (pages.empty()) scene_.for_each_cell([&](const SceneCell& cell) { add(of_cell(cell)); });
  visit(std::move(found));
  for (std::size_t page = share; page < pages.size(); page += shares) {
    found.clear();
    scene_.for_each_cell_below(pages[page], [&](const SceneCell& cell) { found.push_back(of_cell(cell)); });
    visit(std::move(found));
  }
}

}  // namespace gigabake
