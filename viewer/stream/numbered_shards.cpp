#include "viewer/stream/numbered_shards.h"

#include <limits>
#include <utility>

#include "lattice/counted.h"
#include "lattice/error.h"

namespace gigabake {
namespace {

/// Some 300 KB each, of a full page of cells.
constexpr std::size_t most_kept = 32;
constexpr std::int32_t deepest = std::numeric_limits<std::int32_t>::max();

}  // namespace

NumberedShards::NumberedShards(std::shared_ptr<const PagedScene> scene,
                               std::shared_ptr<std::atomic<std::uint64_t>> files_opened)
    : scene_(std::move(scene)), files_opened_(std::move(files_opened)) {}

/// Two threads may read the same page at the same time; one of the two is kept.
std::shared_ptr<const ScenePage> NumberedShards::read(const PageReference& reference, std::uint32_t first,
                                                      std::int32_t depth) {
  const auto find = [&] {
    for (auto kept = kept_.begin(); kept != kept_.end(); ++kept)
      if (kept->first == first && kept->depth == depth) {
        kept_.splice(kept_.begin(), kept_, kept);
        return kept->page;
      }
    return std::shared_ptr<const ScenePage>();
  };
  {
    const std::scoped_lock lock(mutex_);
    if (auto page = find()) return page;
  }
  auto page = std::make_shared<const ScenePage>(read_page(scene_->file(), scene_->header(), reference));
  if (files_opened_) ++*files_opened_;
  const std::scoped_lock lock(mutex_);
  if (auto other = find()) return other;
  kept_.push_front({first, depth, page});
  if (kept_.size() > most_kept) kept_.pop_back();
  return page;
}

/// The page of the cell that lies `depth` below those that scene.xml refers to, or the one that lists it.
NumberedShards::Kept NumberedShards::page_with(std::uint32_t cell, std::int32_t depth) {
  Kept at{0, -1, std::shared_ptr<const ScenePage>(scene_, &scene_->root())};
  while (at.depth < depth && !at.page->pages.empty()) {
    const PageReference* found = nullptr;
    for (const PageReference& reference : at.page->pages) {
      if (cell - at.first < reference.totals.cells) {
        found = &reference;
        break;
      }
      at.first += std::uint32_t(reference.totals.cells);
    }
    if (found == nullptr) break;
    ++at.depth;
    at.page = read(*found, at.first, at.depth);
  }
  return at;
}

SceneCell NumberedShards::shard(std::uint32_t number) {
  const std::uint64_t cells = scene_->totals().cells;
  const std::vector<SceneCell>& parents = scene_->header().parents;
  if (number >= cells && number - cells < parents.size()) return parents[number - cells];
  const Kept listing = page_with(number, deepest);
  if (number < cells && number - listing.first < listing.page->cells.size())
    return listing.page->cells[number - listing.first];
  throw InputError(scene_->file(), "shard " + std::to_string(number),
                   "the scene has " + counted(cells, "cell") + " and " + counted(parents.size(), "parent"));
}

Page NumberedShards::listing(const PageKey& key) {
  const Kept listing = page_with(key.shard, PageKey::listing - key.part);
  Page page;
  page.cells = listed_cells(listing.page->cells, listing.first);
  page.pages = listed_pages(listing.page->pages, listing.first);
  return page;
}

}  // namespace gigabake
