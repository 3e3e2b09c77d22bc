/// Lookup of the shard, a cell or an overview, that stores a level at a position.
///
/// Cells and overviews are found in the listings of the scene's pages (page.h), which the pager loads. If a scene has
/// pages, the memory therefore does not grow with the number of cells.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/math/vec3.h"
#include "format/scene/paged_scene.h"
#include "kernels/marching/locate.h"
#include "viewer/stream/exchange/shard_table.h"
#include "viewer/stream/found_pages.h"
#include "viewer/stream/overview_levels.h"
#include "viewer/stream/pager.h"

namespace gigabake {

/// Data that a lookup could not read.
struct MissingPages {
  kernels::VoxelBox own{};           ///< set by the caller: `damaged` concerns only shards that store this box
  std::vector<PageKey> missing;      ///< not resident yet; may contain duplicates
  bool damaged = false;              ///< a page of a shard that stores `own` cannot be read
  bool is_overview_damaged = false;  ///< an overview's page cannot be read; its children may have more data
  FoundPages* found = nullptr;       ///< set by the caller: pages that the thread found before in this pass, or null
};

struct ShardExtent {
  std::uint32_t number = 0;  ///< PageKey::shard
  std::int32_t first_lod = 0, lods = 0;
  std::int32_t own_lod = 0;  ///< finest level of the shard that no child stores
  kernels::VoxelBox window{};

  bool is_overview() const { return first_lod != 0; }
  int top() const { return first_lod + lods - 1; }
};

bool overlap(const kernels::VoxelBox& a, const kernels::VoxelBox& b);

/// Returns the page; null if it is not resident. Adds the page to missing_pages.missing unless Pager::is_damaged().
const Page* find_page(const Pager& pager, const PageKey& key, MissingPages& missing_pages);

/// The shards of a scene. Several threads may call const members concurrently between two passes of the pager.
class ShardMap {
 public:
  /// Creates a map of cells only, which are all in memory. cells[i] has the shard number i.
  /// Range   lay_out_cells() accepts the cells.
  explicit ShardMap(const std::vector<SceneCell>& cells);
  /// Creates a map of cells only, with the given numbers.
  ShardMap(const std::vector<SceneCell>& cells, const std::vector<std::uint32_t>& numbers);
  /// Creates a map of a scene with overviews. It finds cells and overviews through the scene's pages.
  ShardMap(const PagedScene& scene, OverviewLevels levels);
  /// Creates a map of a scene with overviews, with the given numbers.
  ShardMap(const PagedScene& scene, OverviewLevels levels, const ShardNumbers& numbers);

  /// Returns the number of the last provider of level `lod`. A level may be stored several times: by the cells or by
  /// one overview level, and as duplicates by coarser overview levels. Each of these is a provider. Provider 0 has the
  /// largest shards, so an image needs fewer of them. The last provider stores the original level.
  int last_provider(int lod) const;

  /// Returns the shard of provider `provider` that contains lod-0 voxel v and stores level `lod`. If there is none,
  /// returns nullopt and sets `empty` to a box around v that no shard overlaps. If a page is missing, returns nullopt
  /// and adds the page to `missing_pages`.
  /// Range   `provider` ≤ last_provider(lod), also for any().
  std::optional<ShardExtent> find(int lod, int provider, const Vec3i64& v, const Pager& pager,
                                  MissingPages& missing_pages, kernels::VoxelBox& empty) const;

  /// Calls visit(ShardExtent) for the shards of level `lod` that overlap the box until one call returns true.
  template <class Visit>
  bool any(int lod, int provider, const kernels::VoxelBox& box, const Pager& pager, MissingPages& missing_pages,
           const Visit& visit) const {
    if (lod >= cell_lods_ || provider < last_provider(lod))
      return any_overview(overview_levels_->provider(lod, std::size_t(provider)), box, pager, missing_pages, visit);
    for (std::int64_t y = box.min[1] >> cell_bits_; y <= (box.max[1] - 1) >> cell_bits_; ++y)
      for (std::int64_t x = box.min[0] >> cell_bits_; x <= (box.max[0] - 1) >> cell_bits_; ++x)
        if (any_of_column(x << cell_bits_, y << cell_bits_, box, pager, missing_pages, visit)) return true;
    return false;
  }

 private:
  using Cells = std::vector<ListedCell>;
  static Cells::const_iterator first_above(const Cells& cells, const Vec3i64& min);
  ShardExtent placed(const ListedCell& cell) const;
  const Page* find_listing(const ListedPage& listed, std::int32_t part, const kernels::VoxelBox& missed,
                           const Pager& pager, MissingPages& missing_pages) const;
  /// Returns the overview at a block of the overview level. Returns nullopt if there is none, or if a page that may
  /// list it is not resident.
  std::optional<ShardExtent> find_overview(const OverviewLevel& level, const OverviewBlock& block, const Pager& pager,
                                           MissingPages& missing_pages) const;
  const Cells* cells_around(const Vec3i64& v, const Pager& pager, MissingPages& missing_pages,
                            LatticeBlock& block) const;
  std::optional<ShardExtent> find_cell(const Vec3i64& v, const Pager& pager, MissingPages& missing_pages,
                                       kernels::VoxelBox& empty) const;

  template <class Visit>
  bool any_overview(const OverviewLevel& level, const kernels::VoxelBox& box, const Pager& pager,
                    MissingPages& missing_pages, const Visit& visit) const {
    const OverviewBlock low = level.block_of(box.min);
    const OverviewBlock high = level.block_of(box.max - Vec3i64::all(1));
    for (std::int64_t z = low[2]; z <= high[2]; ++z)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t x = low[0]; x <= high[0]; ++x) {
          const std::optional<ShardExtent> found = find_overview(level, {x, y, z}, pager, missing_pages);
          if (found && visit(*found)) return true;
        }
    return false;
  }

  /// Visits the cells of the column at x, y that overlap the box in z. The cells of a column may be in several
  /// listings, stacked in z.
  template <class Visit>
  bool any_of_column(std::int64_t x, std::int64_t y, const kernels::VoxelBox& box, const Pager& pager,
                     MissingPages& missing_pages, const Visit& visit) const {
    const std::int64_t edge = std::int64_t(1) << cell_bits_;
    for (std::int64_t low = box.min[2] - edge + 1; low < box.max[2];) {
      LatticeBlock block;
      const Cells* cells = cells_around({x, y, low}, pager, missing_pages, block);
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
  ShardNumbers paged_;  ///< replaced shards of a scene with pages
  std::optional<OverviewLevels> overview_levels_;
  std::uint32_t cell_count_ = 0;
  Cells cells_;  ///< listed in scene.xml itself, like the next two members
  std::vector<ListedPage> pages_;
  std::vector<ListedOverview> overviews_;
};

}  // namespace gigabake
