#include "viewer/stream/requests/pooled_pages.h"

#include <algorithm>
#include <utility>

namespace gigabake {
namespace {

/// The size of a page per brick that needs it, up to which an upload is worth its time. The copy of this many bytes and
/// the copy of the voxels of a brick take about 5 µs of a core.
constexpr std::uint64_t bytes_per_use = std::uint64_t(32) << 10;
/// The fraction of the ring whose pages are uploaded again before they are used. New pages would otherwise replace the
/// pages that bricks wait for.
constexpr std::uint64_t old_part = 8;

std::uint32_t voxel_count(const Page& page) { return std::uint32_t(page.bricks.rgba.size() / 4); }

}  // namespace

PooledPages::PooledPages(const kernels::PagePoolSize& size) : size_(size), end_(size.voxels) {}

void PooledPages::count_use(const BrickPages& pages) const {
  for (const Page* page : pages) {
    if (page == nullptr) break;
    if (!is_in_pool(*page)) ++page->pool_mark.uses;
  }
}

bool PooledPages::place(const BrickPages& pages, kernels::CastBrick& brick) {
  for (std::size_t i = 0; i < pages.size() && pages[i] != nullptr; ++i) {
    const Page& page = *pages[i];
    if (!is_in_pool(page)) {
      if (!has_columns_of(page) || !is_worth_upload(page)) return false;
      const std::optional<std::uint64_t> position = position_for(page);
      if (!position) return false;
      page.pool_mark = {*position, 0};
      new_pages_.push_back({voxels_of(page), voxel_count(page), place_of(page)});
    }
    min_used_ = std::min(min_used_, page.pool_mark.position);
    brick.pages[i] = place_of(page);
  }
  return true;
}

std::vector<kernels::PageUpload> PooledPages::take_new_pages() { return std::exchange(new_pages_, {}); }

std::uint64_t PooledPages::bytes_used() const {
  return size_.bytes_per_voxel() * std::min<std::uint64_t>(end_ - size_.voxels, size_.voxels);
}

bool PooledPages::is_in_pool(const Page& page) const {
  const std::uint64_t position = page.pool_mark.position;
  return position != 0 && end_ - position <= size_.voxels - size_.voxels / old_part;
}

bool PooledPages::is_worth_upload(const Page& page) const {
  return voxel_count(page) * size_.bytes_per_voxel() <= page.pool_mark.uses * bytes_per_use;
}

/// Returns whether the pool has the columns that shading reads. Scenes of several versions may have others.
bool PooledPages::has_columns_of(const Page& page) const {
  const BrickBlock& bricks = page.bricks;
  return (bricks.directional_coverage.empty() || size_.has_directional_coverage) &&
         (!bricks.normal.empty() || !size_.has_normals);
}

/// Returns the next free position that keeps the page in one piece. Returns none if the page is too large, or would
/// replace a page that is in use.
std::optional<std::uint64_t> PooledPages::position_for(const Page& page) {
  const std::uint64_t count =
      (voxel_count(page) + kernels::page_alignment - 1) / kernels::page_alignment * kernels::page_alignment;
  if (count > size_.voxels / old_part) return {};
  const std::uint64_t before = end_ % size_.voxels;
  const std::uint64_t position = before + count <= size_.voxels ? end_ : end_ + size_.voxels - before;
  if (position + count - size_.voxels > min_used_) return {};
  end_ = position + count;
  return position;
}

kernels::PooledPage PooledPages::place_of(const Page& page) const {
  return {std::uint32_t(page.pool_mark.position % size_.voxels), !page.bricks.directional_coverage.empty(),
          size_.has_classes && !page.bricks.voxel_class.empty()};
}

}  // namespace gigabake
