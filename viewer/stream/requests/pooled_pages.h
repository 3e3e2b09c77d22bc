/// The pages in the page pool of a caster. The pool is a ring: a new page replaces the oldest ones.
///
/// A caster with a page pool copies the voxels of bricks out of the pool, so the host only lists them. A page is
/// uploaded once enough bricks have needed it: for a few bricks of a large page, the host copies the voxels in less
/// time than the upload takes.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "kernels/render/page_pool.h"
#include "viewer/stream/brick_fill.h"
#include "viewer/stream/page.h"

namespace gigabake {

class PooledPages {
 public:
  explicit PooledPages(const kernels::PagePoolSize& size);

  /// Returns whether the caster has a page pool.
  bool has_pool() const { return size_.voxels != 0; }

  /// Counts a brick that needs the pages of its runs.
  void count_use(const BrickPages& pages) const;
  /// Sets CastBrick::pages to the places of `pages` in the pool; pages that are not in the pool get a place, and
  /// take_new_pages() returns them. Returns false if a page is not worth its upload, or gets no place. All places stay
  /// until release().
  bool place(const BrickPages& pages, kernels::CastBrick& brick);
  /// Returns the pages that got a place since the last call. Upload them before the pager's next pass, and before the
  /// bricks.
  std::vector<kernels::PageUpload> take_new_pages();
  /// Allows new pages to replace all others. Call it when no brick waits for its upload.
  void release() { min_used_ = std::numeric_limits<std::uint64_t>::max(); }

  /// Returns the number of bytes of the pool that were ever used.
  std::uint64_t bytes_used() const;

 private:
  bool is_in_pool(const Page& page) const;
  bool is_worth_upload(const Page& page) const;
  bool has_columns_of(const Page& page) const;
  std::optional<std::uint64_t> position_for(const Page& page);
  kernels::PooledPage place_of(const Page& page) const;

  kernels::PagePoolSize size_;
  // Positions count all voxels since the start. The index in the pool is the position modulo its size.
  std::uint64_t end_;                                                   ///< position after the newest page
  std::uint64_t min_used_ = std::numeric_limits<std::uint64_t>::max();  ///< of the pages placed since release()
  std::vector<kernels::PageUpload> new_pages_;
};

}  // namespace gigabake
