#include "query/query_places.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "core/base/error.h"
#include "query/lost_cells.h"

namespace gigabake {
namespace {

using kernels::VoxelBox;

VoxelBox window_box(const Vec3i64& min, std::int64_t edge) {
  VoxelBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.min[a] = min[a];
    box.max[a] = min[a] + edge;
  }
  return box;
}

using LatticeCorner = Vec3i64;

struct CornerHash {
  std::size_t operator()(const LatticeCorner& corner) const {
    std::uint64_t hash = 0;
    for (const std::int64_t c : corner) hash = (hash ^ std::uint64_t(c)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
    return hash;
  }
};

constexpr int page_threads = 2;

}  // namespace

QueryPlaces::QueryPlaces(NumberedShards& numbers, std::uint64_t page_bytes, const ThreadPool& pool)
    : numbers_(numbers) {
  const PagedScene& scene = numbers.scene();
  first_lost_ = std::uint32_t(scene.totals().cells + scene.totals().overviews);
  std::optional<OverviewLevels> levels;
  if (!has_lost_cells(scene.header())) levels = overview_levels(scene);
  if (!levels) {
    lay_out(scene, pool);
    return;
  }
  lods_ = levels->levels.back().first_lod + levels->levels.back().lods;
  window_.min = scene.totals().window.min;
  window_.max = scene.totals().window.end;
  map_.emplace(scene, std::move(*levels));
  pager_ = std::make_unique<Pager>([this](const PageKey& key) { return read_page(key); },
                                   Pager::Options{page_threads, page_bytes});
}

/// Sets the layout, and the shard number of each cell in the layout.
void QueryPlaces::place_cells(const PagedScene& scene, const ThreadPool& pool) {
  std::vector<SceneCell> cells = scene.cells(pool);
  const auto stored = std::uint32_t(cells.size());
  if (!cells.empty())
    for (SceneCell& cell : lost_cells(scene.header(), cells)) {
      lost_.push_back(cell.name);
      cells.push_back(std::move(cell));
    }
  layout_ = lay_out_cells(cells, scene.file());
  std::unordered_map<LatticeCorner, std::uint32_t, CornerHash> number_at;
  for (std::uint32_t i = 0; i < cells.size(); ++i)
    number_at.emplace(cells[i].lattice_min, i < stored ? i : first_lost_ + (i - stored));
  for (const kernels::CastCell& cell : layout_.cells) {
    const auto found = number_at.find({cell.min[0], cell.min[1], cell.min[2]});
    number_.push_back(found == number_at.end() ? kernels::no_cell : found->second);
  }
}

void QueryPlaces::lay_out_all(const ThreadPool& pool) {
  if (layout_.cells.empty()) place_cells(numbers_.scene(), pool);
}

std::optional<std::uint32_t> QueryPlaces::shard_of_cell(std::size_t cell) const {
  if (number_[cell] == kernels::no_cell) return {};
  return number_[cell];
}

void QueryPlaces::lay_out(const PagedScene& scene, const ThreadPool& pool) {
  place_cells(scene, pool);
  lods_ = layout_.scene.lods;
  for (int a = 0; a < 3; ++a) {
    window_.min[a] = std::int64_t(layout_.scene.min[a]);
    window_.max[a] = std::int64_t(layout_.scene.max[a]);
  }
}

/// Reads a page. The pager's threads call this function.
Page QueryPlaces::read_page(const PageKey& key) {
  try {
    return numbers_.listing(key);
  } catch (const InputError&) {
    const std::scoped_lock lock(mutex_);
    if (!unreadable_) unreadable_ = std::current_exception();
    throw;
  }
}

void QueryPlaces::read(const std::vector<PageKey>& pages) {
  if (!pager_) return;
  if (!pages.empty()) {
    pager_->request(pages);
    pager_->wait();
  }
  pager_->begin_pass();
  const std::scoped_lock lock(mutex_);
  if (unreadable_) std::rethrow_exception(unreadable_);
}

QueryPlace QueryPlaces::find_in_layout(const std::int64_t v[3]) const {
  QueryPlace place;
  std::uint32_t cell = 0;
  if (!kernels::find_cell(layout_.scene, {v[0], v[1], v[2]}, cell, place.box)) return place;
  const kernels::CastCell& found = layout_.cells[cell];
  place.box = window_box({found.min[0], found.min[1], found.min[2]}, std::int64_t(1) << layout_.scene.cell_bits);
  if (number_[cell] == kernels::no_cell) return place;
  place.shard = number_[cell];
  place.kind = is_lost(place.shard) ? QueryPlace::Kind::lost : QueryPlace::Kind::shard;
  return place;
}

QueryPlace QueryPlaces::find_in_pages(int lod, const std::int64_t v[3]) const {
  QueryPlace place;
  MissingPages missing_pages;
  const std::optional<ShardExtent> found =
      map_->find(lod, map_->last_provider(lod), {v[0], v[1], v[2]}, *pager_, missing_pages, place.box);
  if (found) {
    place.kind = QueryPlace::Kind::shard;
    place.shard = found->number;
    place.box = found->window;
  } else if (!missing_pages.missing.empty()) {
    place.kind = QueryPlace::Kind::unknown;
    place.page = missing_pages.missing.front();
  }
  return place;
}

QueryPlace QueryPlaces::find(int lod, const std::int64_t v[3]) const {
  return map_ ? find_in_pages(lod, v) : find_in_layout(v);
}

}  // namespace gigabake
