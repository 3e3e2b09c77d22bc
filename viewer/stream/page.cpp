#include "viewer/stream/page.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "viewer/stream/open_shards.h"

namespace gigabake {

std::uint64_t Page::bytes() const {
  return sizeof(Page) + rows.size() * sizeof(NodeRow) + bricks.mask.size() * sizeof(std::uint64_t) +
         bricks.first.size() * sizeof(std::uint32_t) + bricks.rgba.size() + bricks.normal.size() +
         bricks.directional_coverage.size() + bricks.voxel_class.size() * sizeof(VoxelClass) +
         cells.size() * sizeof(ListedCell) + pages.size() * sizeof(ListedPage) +
         overviews.size() * sizeof(ListedOverview);
}

std::vector<ListedCell> listed_cells(const std::vector<SceneCell>& cells, std::uint32_t first) {
  std::vector<ListedCell> listed;
  listed.reserve(cells.size());
  for (const SceneCell& cell : cells) listed.push_back({cell.lattice_min, first++});
  std::sort(listed.begin(), listed.end(), [](const ListedCell& a, const ListedCell& b) { return a.min < b.min; });
  return listed;
}

std::vector<ListedOverview> listed_overviews(const std::vector<SceneCell>& overviews, std::uint32_t first) {
  std::vector<ListedOverview> listed;
  listed.reserve(overviews.size());
  for (const SceneCell& overview : overviews) listed.push_back({overview.own_lod(), overview.lattice_min, first++});
  std::sort(listed.begin(), listed.end(), [](const ListedOverview& a, const ListedOverview& b) {
    return std::tie(a.own_lod, a.min) < std::tie(b.own_lod, b.min);
  });
  return listed;
}

std::vector<ListedPage> listed_pages(const std::vector<PageReference>& pages, std::uint32_t first) {
  std::vector<ListedPage> listed;
  for (const PageReference& page : pages) {
    listed.push_back({page.block, first});
    first += std::uint32_t(page.totals.cells);
  }
  return listed;
}

PageSource pages_from_files(std::shared_ptr<const PagedScene> scene,
                            std::shared_ptr<std::atomic<std::uint64_t>> files_opened) {
  return pages_from_open_shards(std::move(scene), std::move(files_opened), max_open_shards);
}

Page page_of(const ShardPages& shard, const PageKey& key) {
  Page page;
  if (key.part == PageKey::node_rows)
    page.rows = shard.nodes(std::uint64_t(key.block) * nodes_per_block, nodes_per_block);
  else
    page.bricks = shard.level(key.part, std::uint64_t(key.block) * bricks_per_block, bricks_per_block);
  return page;
}

PageSource pages_from_open_shards(std::shared_ptr<const PagedScene> scene,
                                  std::shared_ptr<std::atomic<std::uint64_t>> files_opened, std::size_t max_open,
                                  std::shared_ptr<ChunkCache> chunks) {
  struct Files {
    NumberedShards numbers;
    OpenShards shards;
    Files(std::shared_ptr<const PagedScene> scene, const std::shared_ptr<std::atomic<std::uint64_t>>& opened,
          std::size_t max_open, std::shared_ptr<ChunkCache> chunks)
        : numbers(std::move(scene), opened), shards(numbers, max_open, opened, std::move(chunks)) {}
  };
  return [files = std::make_shared<Files>(std::move(scene), files_opened, max_open, std::move(chunks))](
             const PageKey& key) {
    if (key.part <= PageKey::listing) return files->numbers.listing(key);
    return page_of(*files->shards.get(key.shard), key);
  };
}

}  // namespace gigabake
