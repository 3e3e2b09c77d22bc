#include "viewer/stream/shard_map.h"

#include <bit>
#include <tuple>
#include <utility>

#include "core/octree/brick.h"

namespace gigabake {
namespace {

using kernels::VoxelBox;

constexpr std::int64_t everywhere = kernels::far_voxel;

VoxelBox cube_at(const Vec3i64& min, std::int64_t edge) { return {min, min + Vec3i64::all(edge)}; }

/// Returns the listed page of the block, or null. Blocks of a listing have equal size and are sorted by z, y, x.
const ListedPage* page_around(const std::vector<ListedPage>& pages, const LatticeBlock& block) {
  const auto order = [](const LatticeBlock& b) { return b.min.zyx(); };
  const auto found = std::lower_bound(pages.begin(), pages.end(), order(block),
                                      [&](const ListedPage& page, const auto& zyx) { return order(page.block) < zyx; });
  return found != pages.end() && found->block == block ? &*found : nullptr;
}

const ListedOverview* overview_at(const std::vector<ListedOverview>& overviews, std::uint32_t own_lod,
                                  const Vec3i64& min) {
  const auto found = std::lower_bound(overviews.begin(), overviews.end(), std::tie(own_lod, min),
                                      [](const ListedOverview& overview, const auto& requested) {
                                        return std::tie(overview.own_lod, overview.min) < requested;
                                      });
  return found != overviews.end() && found->own_lod == own_lod && found->min == min ? &*found : nullptr;
}

}  // namespace

bool overlap(const VoxelBox& a, const VoxelBox& b) {
  for (int i = 0; i < 3; ++i)
    if (a.max[i] <= b.min[i] || b.max[i] <= a.min[i]) return false;
  return true;
}

const Page* find_page(const Pager& pager, const PageKey& key, MissingPages& missing_pages) {
  if (missing_pages.found != nullptr)
    if (const Page* page = missing_pages.found->find(key)) return page;
  const Page* page = pager.find(key);
  if (page == nullptr && !pager.is_damaged(key)) missing_pages.missing.push_back(key);
  if (page != nullptr && missing_pages.found != nullptr) missing_pages.found->add(key, page);
  return page;
}

ShardMap::ShardMap(const std::vector<SceneCell>& cells)
    : cell_lods_(std::int32_t(kernels::max_cast_lods)),
      cell_bits_(std::countr_zero(cells.at(0).cell_voxels)),
      cell_count_(std::uint32_t(cells.size())),
      cells_(listed_cells(cells, 0)) {}

ShardMap::ShardMap(const std::vector<SceneCell>& cells, const std::vector<std::uint32_t>& numbers) : ShardMap(cells) {
  for (ListedCell& cell : cells_) cell.number = numbers.at(cell.number);
}

ShardMap::ShardMap(const PagedScene& scene, OverviewLevels levels, const ShardNumbers& numbers)
    : ShardMap(scene, std::move(levels)) {
  if (!pages_.empty()) {
    paged_ = numbers;
    return;
  }
  for (ListedCell& cell : cells_) cell.number = numbers.cells.at(cell.number);
  // find_overview() adds cell_count_, modulo 2^32.
  for (ListedOverview& overview : overviews_) overview.index = numbers.overviews.at(overview.index) - cell_count_;
}

ShardMap::ShardMap(const PagedScene& scene, OverviewLevels levels)
    : cell_lods_(levels.levels.front().own_lod()),
      cell_bits_(std::countr_zero(scene.totals().cell_voxels)),
      overview_levels_(std::move(levels)),
      cell_count_(std::uint32_t(scene.totals().cells)),
      cells_(listed_cells(scene.root().cells, 0)),
      pages_(listed_pages(scene.root().pages, 0)),
      overviews_(listed_overviews(scene.root().overviews, 0)) {}

ShardMap::Cells::const_iterator ShardMap::first_above(const Cells& cells, const Vec3i64& min) {
  return std::lower_bound(cells.begin(), cells.end(), min,
                          [](const ListedCell& cell, const auto& v) { return cell.min < v; });
}

ShardExtent ShardMap::placed(const ListedCell& cell) const {
  return {paged_.of_paged(cell.number), 0, cell_bits_ - 2, 0, cube_at(cell.min, std::int64_t(1) << cell_bits_)};
}

/// Returns the listing; null if it is not resident. If it can never be read and its shards may overlap gaps.own, sets
/// gaps.damaged. `missed` contains these shards.
const Page* ShardMap::find_listing(const ListedPage& listed, std::int32_t part, const VoxelBox& missed,
                                   const Pager& pager, MissingPages& missing_pages) const {
  const PageKey key{listed.first_cell, part, 0};
  const Page* page = find_page(pager, key, missing_pages);
  if (page == nullptr && pager.is_damaged(key)) missing_pages.damaged |= overlap(missed, missing_pages.own);
  return page;
}

/// Descends through the scene's pages: an overview is listed in the smallest page whose block contains it.
std::optional<ShardExtent> ShardMap::find_overview(const OverviewLevel& level, const OverviewBlock& block,
                                                   const Pager& pager, MissingPages& missing_pages) const {
  const Vec3i64 corner = level.corner_of(block);
  const VoxelBox window = cube_at(corner, level.edge());
  const std::vector<ListedOverview>* overviews = &overviews_;
  const std::vector<ListedPage>* pages = &pages_;
  for (std::int32_t part = PageKey::listing;; --part) {
    if (const ListedOverview* found = overview_at(*overviews, std::uint32_t(level.own_lod()), corner))
      return ShardExtent{paged_.of_paged(cell_count_ + found->index), level.first_lod, level.lods, level.own_lod(),
                         window};
    if (pages->empty() || pages->front().block.edge < level.edge()) return {};
    const ListedPage* listed = page_around(*pages, block_around(corner, pages->front().block.edge));
    const Page* page = listed != nullptr ? find_listing(*listed, part, window, pager, missing_pages) : nullptr;
    if (page == nullptr) return {};
    overviews = &page->overviews;
    pages = &page->pages;
  }
}

/// Returns the list of the cells that begin in the block around v. Returns null if there are none or the listing is not
/// resident.
const ShardMap::Cells* ShardMap::cells_around(const Vec3i64& v, const Pager& pager, MissingPages& missing_pages,
                                              LatticeBlock& block) const {
  block = {{-everywhere, -everywhere, -everywhere}, 2 * everywhere};
  if (pages_.empty()) return &cells_;
  const std::vector<ListedPage>* pages = &pages_;
  for (std::int32_t part = PageKey::listing;; --part) {
    block = block_around(v, pages->front().block.edge);
    const ListedPage* listed = page_around(*pages, block);
    if (listed == nullptr) return nullptr;  // no cell begins there
    VoxelBox box = cube_at(block.min, block.edge);
    box.max[2] += std::int64_t(1) << cell_bits_;  // cells may extend above the block
    const Page* page = find_listing(*listed, part, box, pager, missing_pages);
    if (page == nullptr) return nullptr;
    if (page->pages.empty()) return &page->cells;
    pages = &page->pages;
  }
}

std::optional<ShardExtent> ShardMap::find_cell(const Vec3i64& v, const Pager& pager, MissingPages& missing_pages,
                                               VoxelBox& empty) const {
  const std::int64_t edge = std::int64_t(1) << cell_bits_;
  const Vec3i64 low{v[0] >> cell_bits_ << cell_bits_, v[1] >> cell_bits_ << cell_bits_, v[2]};
  const std::int64_t aligned = v[2] >> cell_bits_ << cell_bits_;
  empty = cube_at({low[0], low[1], aligned}, edge);
  for (std::int64_t z = v[2]; z > aligned - edge;) {
    LatticeBlock block;
    const Cells* cells = cells_around({low[0], low[1], z}, pager, missing_pages, block);
    if (cells != nullptr) {
      auto above = first_above(*cells, {low[0], low[1], z + 1});
      const auto is_here = [&](const ListedCell& cell) { return cell.min[0] == low[0] && cell.min[1] == low[1]; };
      if (above != cells->end() && is_here(*above)) empty.max[2] = std::min(empty.max[2], above->min[2]);
      if (above != cells->begin() && is_here(*--above)) {
        if (above->min[2] + edge > v[2]) return placed(*above);
        empty.min[2] = std::max(aligned, above->min[2] + edge);
        return {};
      }
    }
    z = block.min[2] - 1;
  }
  return {};
}

int ShardMap::last_provider(int lod) const {
  const int overviews = overview_levels_ ? int(overview_levels_->holders(lod)) : 0;
  return lod < cell_lods_ ? overviews : overviews - 1;
}

std::optional<ShardExtent> ShardMap::find(int lod, int provider, const Vec3i64& v, const Pager& pager,
                                          MissingPages& missing_pages, VoxelBox& empty) const {
  if (lod < cell_lods_ && provider == last_provider(lod)) return find_cell(v, pager, missing_pages, empty);
  const OverviewLevel& level = overview_levels_->provider(lod, std::size_t(provider));
  const OverviewBlock block = level.block_of(v);
  empty = cube_at(level.corner_of(block), level.edge());
  return find_overview(level, block, pager, missing_pages);
}

}  // namespace gigabake
