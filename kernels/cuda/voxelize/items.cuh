/// Exact overlap test of a batch's (triangle, brick) pairs. One thread tests a pair; each overlapped slab of the brick
/// becomes an item.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/base/rules.h"
#include "kernels/cuda/voxelize/bin.cuh"

namespace gigabake::kernels {

/// Number of pairs in a group, which one block processes together. A group's items are stored consecutively, in the
/// order of its pairs.
inline constexpr unsigned pairs_per_group = 256;
/// Max number of pairs of a batch: ItemView::where has 26 bits for the pair.
inline constexpr std::uint32_t max_pairs_of_batch = std::uint32_t(1) << 26;

/// Arrays of items. An item is the overlap of a triangle with one slab of a brick: 64 cells across the triangle's
/// dominant axis.
struct ItemView {
  std::uint64_t* cells;      ///< bit u + 8 v
  std::uint32_t* where;      ///< pair (of the batch) << 6 | wide << 5 | axis << 3 | slab; wide: needs 128-bit integers
  std::uint32_t* first;      ///< [pair of the batch] its first item
  std::uint32_t* group_end;  ///< [group] end of its items
  std::uint32_t capacity;    ///< capacity of `cells` and `where`
  std::uint32_t pairs;       ///< capacity of `first`
  std::uint32_t* count;      ///< items found so far; may exceed the capacity
  const std::uint32_t* is_stopped;  ///< not 0: find_items() does nothing
};

/// Bricks and their triangles, in the layout of BrickLists.
struct BricksView {
  const std::uint32_t *key, *start, *triangle;
};

/// A range of consecutive items.
struct ItemRange {
  std::uint32_t begin, end;
};

/// Iterator over all items of the pairs [first, end) of a batch of `pairs`, range by range. All threads of a block or
/// warp iterate identically.
class FragmentIterator {
 public:
  __device__ FragmentIterator(const ItemView& items, std::uint32_t first, std::uint32_t end, std::uint32_t pairs)
      : items_(&items), first_(first), end_(end), pairs_(pairs), group_(first / pairs_per_group) {
    if (first < end) open_group();  // without pairs there are no items to read
  }
  __device__ bool has_more() const { return range_.begin < range_.end; }
  /// Returns the next range, of at most `maximum` items.
  __device__ ItemRange take(std::uint32_t maximum) {
    const ItemRange taken{range_.begin, range_.begin + smaller(maximum, range_.end - range_.begin)};
    range_.begin = taken.end;
    open_group();
    return taken;
  }

 private:
  __device__ void open_group() {
    for (; !has_more() && group_ * pairs_per_group < end_; ++group_) {
      const std::uint32_t group_first = group_ * pairs_per_group, next_group = group_first + pairs_per_group;
      const bool ends_group = end_ >= next_group || end_ == pairs_;
      range_ = {items_->first[larger(first_, group_first)],
                ends_group ? items_->group_end[group_] : items_->first[end_]};
    }
  }

  const ItemView* items_;
  std::uint32_t first_, end_, pairs_, group_;
  ItemRange range_{0, 0};
};

/// Finds the items of the bricks [begin, end). Launch with pairs_per_group threads per block and any number of blocks.
__global__ void find_items(InputView in, SurfaceRule rule, BricksView bricks, std::uint32_t begin, std::uint32_t end,
                           ItemView items);

}  // namespace gigabake::kernels
