#include "viewer/stream/numbered_shards.h"

#include <utility>

#include "core/base/error.h"
#include "core/base/pluralize.h"

namespace gigabake {
namespace {

/// The maximum number of cached pages. A full page of cells takes about 300 KB.
constexpr std::size_t max_pages = 32;
constexpr std::int32_t deepest = 64;  // the block edge halves with each page level

}  // namespace

NumberedShards::NumberedShards(std::shared_ptr<const PagedScene> scene,
                               std::shared_ptr<std::atomic<std::uint64_t>> files_opened)
    : scene_(std::move(scene)), files_opened_(std::move(files_opened)), pages_(max_pages) {}

/// Returns a page from the cache or the file.
std::shared_ptr<const ScenePage> NumberedShards::read(const PageReference& reference, std::uint32_t first,
                                                      std::int32_t depth) {
  return pages_.get(std::uint64_t(first) << 32 | std::uint32_t(depth), [&] {
    auto page = std::make_shared<const ScenePage>(read_page(scene_->file(), scene_->header(), reference));
    if (files_opened_) ++*files_opened_;
    return page;
  });
}

/// Returns the page at `depth` on the path to the item that `is_below` finds. Depth 0 is a page to which scene.xml
/// refers; each reference from page to page adds 1. If the path ends earlier, returns its last page.
NumberedShards::Listing NumberedShards::page_with(const IsBelow& is_below, std::int32_t depth) {
  Listing at{0, 0, std::shared_ptr<const ScenePage>(scene_, &scene_->root())};
  for (std::int32_t next = 0; next <= depth; ++next) {
    std::uint32_t first = at.first_cell, first_overview = at.first_overview + std::uint32_t(at.page->overviews.size());
    const PageReference* found = nullptr;
    for (const PageReference& reference : at.page->pages) {
      if (is_below(reference, first, first_overview)) {
        found = &reference;
        break;
      }
      first += std::uint32_t(reference.totals.cells);
      first_overview += std::uint32_t(reference.totals.overviews);
    }
    if (found == nullptr) break;
    at = {first, first_overview, read(*found, first, next)};
  }
  return at;
}

NumberedShards::Listing NumberedShards::page_with_cell(std::uint32_t cell, std::int32_t depth) {
  return page_with([cell](const PageReference& reference, std::uint32_t first,
                          std::uint32_t) { return cell - first < reference.totals.cells; },
                   depth);
}

SceneCell NumberedShards::shard(std::uint32_t number) {
  const std::uint64_t cells = scene_->totals().cells, overviews = scene_->totals().overviews;
  if (number < cells) {
    const Listing listing = page_with_cell(number, deepest);
    if (number - listing.first_cell < listing.page->cells.size())
      return listing.page->cells[number - listing.first_cell];
  } else if (number - cells < overviews) {
    const auto index = std::uint32_t(number - cells);
    const Listing listing =
        page_with([index](const PageReference& reference, std::uint32_t,
                          std::uint32_t first) { return index >= first && index - first < reference.totals.overviews; },
                  deepest);
    if (index - listing.first_overview < listing.page->overviews.size())
      return listing.page->overviews[index - listing.first_overview];
  }
  throw InputError(scene_->file(), "shard " + std::to_string(number),
                   "the scene has " + pluralize(cells, "cell") + " and " + pluralize(overviews, "overview"));
}

Page NumberedShards::listing(const PageKey& key) {
  const Listing listing = page_with_cell(key.shard, PageKey::listing - key.part);
  Page page;
  page.cells = listed_cells(listing.page->cells, listing.first_cell);
  page.pages = listed_pages(listing.page->pages, listing.first_cell);
  page.overviews = listed_overviews(listing.page->overviews, listing.first_overview);
  return page;
}

}  // namespace gigabake
