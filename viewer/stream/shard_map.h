/// Which shard of a scene holds what: for each level and place the cell or the parent that it is stored in.
///
/// Cells and parents are found in the lists of the scene's pages, which come through the pager; so nothing here grows
/// with the number of cells of a scene that has pages.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "format/scene/paged_scene.h"
#include "kernels/cast/locate.h"
#include "viewer/stream/pager.h"
#include "viewer/stream/parent_tiers.h"

namespace gigabake {

/// What a question could not read.
struct PageGaps {
  kernels::VoxelBox own{};       ///< set by who asks: only damage of what stores this box matters
  std::vector<PageKey> missing;  ///< not here yet, with repetitions
  bool damaged = false;          ///< a page of what stores `own` will never be here
  bool beside_damaged = false;   ///< a parent's page will never be here, though its children may say more
};

struct PlacedShard {
  std::uint32_t number = 0;  ///< PageKey::shard
  std::int32_t first_lod = 0, lods = 0;
  std::int32_t own_lod = 0;  ///< the finest that no child of it stores
  kernels::VoxelBox window{};

  bool is_parent() const { return first_lod != 0; }
  int top() const { return first_lod + lods - 1; }
};

bool overlap(const kernels::VoxelBox& a, const kernels::VoxelBox& b);

/// Null where the page is not here. `missing` and is_damaged() say why.
const Page* find_page(const Pager& pager, const PageKey& key, PageGaps& gaps);

/// Questions may be asked from several threads at once, between two passes of the pager.
class ShardMap {
 public:
  /// The cells alone, all in memory: number i is cells[i]. Range  cells of one size, as lay_out_cells() takes them.
  explicit ShardMap(const std::vector<SceneCell>& cells);
  /// Through parents, from the root down.
  ShardMap(const PagedScene& scene, ParentTiers tiers);

  /// A level may be stored more than once: holder 0 are the largest shards that have it, of which a picture needs the
  /// fewest; the last are those that it is of, and that others copied it from.
  int last_holder(int lod) const;

  /// The shard of level `lod` that holds lod-0 voxel v; or nothing, and a box around v that no shard reaches into.
  /// Range  holder ≤ last_holder(lod), here and below.
  std::optional<PlacedShard> find(int lod, int holder, const std::int64_t v[3], const Pager& pager, PageGaps& gaps,
                                  kernels::VoxelBox& empty) const;

  /// Calls visit(PlacedShard) for the shards of level `lod` that overlap the box until one says true.
  template <class Visit>
  bool any(int lod, int holder, const kernels::VoxelBox& box, const Pager& pager, PageGaps& gaps,
           const Visit& visit) const {
    if (lod >= cell_lods_ || holder < last_holder(lod))
      return any_parent(tiers_->holder(lod, std::size_t(holder)), box, pager, gaps, visit);
    for (std::int64_t y = box.min[1] >> cell_bits_; y <= (box.max[1] - 1) >> cell_bits_; ++y)
      for (std::int64_t x = box.min[0] >> cell_bits_; x <= (box.max[0] - 1) >> cell_bits_; ++x)
        if (any_of_column(x << cell_bits_, y << cell_bits_, box, pager, gaps, visit)) return true;
    return false;
  }

 private:
  using Cells = std::vector<ListedCell>;
  static Cells::const_iterator first_above(const Cells& cells, const std::array<std::int64_t, 3>& min);
  PlacedShard placed(const ListedCell& cell) const;
  const Page* find_listing(const ListedPage& listed, std::int32_t part, const kernels::VoxelBox& missed,
                           const Pager& pager, PageGaps& gaps) const;
  /// The tier's parent of that block; where a page that may list it is not here, nothing.
  std::optional<PlacedShard> find_parent(const ParentTier& tier, const TierBlock& block, const Pager& pager,
                                         PageGaps& gaps) const;
  const Cells* cells_around(const std::array<std::int64_t, 3>& v, const Pager& pager, PageGaps& gaps,
                            LatticeBlock& block) const;
  std::optional<PlacedShard> find_cell(const std::int64_t v[3], const Pager& pager, PageGaps& gaps,
                                       kernels::VoxelBox& empty) const;

  template <class Visit>
  bool any_parent(const ParentTier& tier, const kernels::VoxelBox& box, const Pager& pager, PageGaps& gaps,
                  const Visit& visit) const {
    const TierBlock low = tier.block_of({box.min[0], box.min[1], box.min[2]});
    const TierBlock high = tier.block_of({box.max[0] - 1, box.max[1] - 1, box.max[2] - 1});
    for (std::int64_t z = low[2]; z <= high[2]; ++z)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t x = low[0]; x <= high[0]; ++x) {
          const std::optional<PlacedShard> found = find_parent(tier, {x, y, z}, pager, gaps);
          if (found && visit(*found)) return true;
        }
    return false;
  }

  /// Cells of the column at x, y that overlap the box in z; they begin in one list or in several, one above the other.
  template <class Visit>
  bool any_of_column(std::int64_t x, std::int64_t y, const kernels::VoxelBox& box, const Pager& pager, PageGaps& gaps,
                     const Visit& visit) const {
    const std::int64_t edge = std::int64_t(1) << cell_bits_;
    for (std::int64_t low = box.min[2] - edge + 1; low < box.max[2];) {
      LatticeBlock block;
      const Cells* cells = cells_around({x, y, low}, pager, gaps, block);
      const std::int64_t end = std::min(box.max[2], block.min[2] + block.edge);
      if (cells != nullptr)
        for (auto cell = first_above(*cells, {x, y, low});
             cell != cells->end() && cell->min[0] == x && cell->min[1] == y && cell->min[2] < end; ++cell)
          if (visit(placed(*cell))) return true;
      low = end;
    }
    return false;
  }

  std::int32_t cell_lods_ = 0, cell_bits_ = 0;
  std::optional<ParentTiers> tiers_;
  std::uint32_t cell_count_ = 0;
  Cells cells_;  ///< that need no page, here and in the two below
  std::vector<ListedPage> pages_;
  std::vector<ListedParent> parents_;
};

}  // namespace gigabake
