#include "format/export/voxel_tiles/tile_stats.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

#include "core/base/error.h"
#include "core/io/bytes.h"
#include "core/octree/morton.h"
#include "format/scene/shard_of_scene.h"

namespace gigabake {
namespace {

/// Adds 1 to the weight of each tile in tiling.tiles_near(lod, box).
void count_in_tiles(const VoxelTiling& tiling, int lod, const Box3i64& box, TileWeights& tiles) {
  const Box3i64 places = tiling.tiles_near(lod, box);
  for (std::int64_t z = places.min[2]; z < places.end[2]; ++z)
    for (std::int64_t y = places.min[1]; y < places.end[1]; ++y)
      for (std::int64_t x = places.min[0]; x < places.end[0]; ++x)
        tiles[{tiling.level(lod), morton(std::uint32_t(x), std::uint32_t(y), std::uint32_t(z))}] += 1;
}

/// Returns whether level `lod` of the shard is not aligned with the lattice. The positions of its voxels are then
/// rounded down to the lattice, and its voxels may lie outside of the bricks of the next finer level.
bool stands_off_the_lattice(const SceneCell& shard, int lod) {
  for (const std::int64_t x : shard.lattice_min)
    if ((x & ((std::int64_t(1) << lod) - 1)) != 0) return true;
  return false;
}

std::vector<std::uint8_t> bytes_of_tiles(const TileWeights& tiles) {
  ByteWriter writer;
  writer.put(std::uint64_t(tiles.size()));
  for (const auto& [tile, weight] : tiles) {
    writer.put(tile.level);
    writer.put(tile.key);
    writer.put(weight);
  }
  return writer.take();
}

void add_tiles(const std::vector<std::uint8_t>& bytes, TileWeights& tiles) {
  ByteReader reader(bytes, "tiles of a rank");
  std::uint64_t count = 0;
  reader.get(count);
  for (; count > 0; --count) {
    TilePlace tile;
    std::uint64_t weight = 0;
    reader.get(tile.level);
    reader.get(tile.key);
    reader.get(weight);
    tiles[tile] += weight;
  }
}

}  // namespace

/// Calls visit(lod, boxes of bricks, thread) for each level of levels_of(owner). The owners are the shards in this
/// rank's partition that own a level from `finest` to `coarsest`.
template <class LevelsOf, class Visit>
void TileStats::for_each_own_level(int finest, int coarsest, const LevelsOf& levels_of, const Visit& visit) const {
  const auto visit_shard = [&](const LevelOwner& owner, int thread) {
    progress_.advance();
    const ShardReader reader = open_shard_of_scene(scene_.file(), scene_.header(), owner.shard);
    const NodeTable nodes = reader.nodes();
    for (const int lod : levels_of(owner)) visit(lod, bricks_of(reader.header(), nodes, lod), thread);
  };
  owners_.for_each(finest, coarsest, std::size_t(team_.rank()), std::size_t(team_.ranks()),
                   [&](const std::vector<LevelOwner>& owners) {
                     pool_.parallel_for(owners.size(), 1, [&](std::size_t i, std::size_t, int thread) {
                       visit_shard(owners[i], thread);
                     });
                   });
}

Box3i64 TileStats::bounds(int lod) const {
  progress_.step("reading the positions of bricks", scene_.totals().cells / std::uint64_t(team_.ranks()), "shard");
  std::vector<Box3i64> own(std::size_t(pool_.threads()));
  const auto levels_that_count = [lod](const LevelOwner& owner) {
    std::vector<int> levels{lod};
    for (int coarser = lod + 1; coarser <= owner.coarsest; ++coarser)
      if (stands_off_the_lattice(owner.shard, coarser)) levels.push_back(coarser);
    return levels;
  };
  team_.together([&] {
    for_each_own_level(lod, lod, levels_that_count, [&](int of, const std::vector<Box3i64>& boxes, int thread) {
      Box3i64& all = own[std::size_t(thread)];
      for (const Box3i64& box : boxes) all = hull(all, on_lattice(box, of));
    });
  });
  ByteWriter writer;
  Box3i64 of_rank;
  for (const Box3i64& box : own) of_rank = hull(of_rank, box);
  writer.put(of_rank);
  Box3i64 all;
  for (const std::vector<std::uint8_t>& bytes : team_.exchange(writer.take())) {
    Box3i64 box;
    ByteReader(bytes, "bounds of a rank").get(box);
    all = hull(all, box);
  }
  return all;
}

TileWeights TileStats::tiles(const VoxelTiling& tiling, const DerivedLevels& made) const {
  progress_.step("listing tiles", (scene_.totals().cells + scene_.totals().overviews) / std::uint64_t(team_.ranks()),
                 "shard");
  std::vector<TileWeights> of_thread(std::size_t(pool_.threads()));
  const auto levels_of_tiles = [&tiling](const LevelOwner& owner) {
    std::vector<int> levels;
    for (int lod = std::max(tiling.finest, owner.finest); lod <= std::min(tiling.coarsest(), owner.coarsest); ++lod)
      levels.push_back(lod);
    return levels;
  };
  const auto count = [&](int lod, const std::vector<Box3i64>& boxes, int thread) {
    for (const Box3i64& box : boxes) count_in_tiles(tiling, lod, box, of_thread[std::size_t(thread)]);
  };
  team_.together([&] {
    for_each_own_level(tiling.finest, tiling.coarsest(), levels_of_tiles, count);
    for (int lod = tiling.finest; team_.rank() == 0 && lod <= tiling.coarsest(); ++lod)
      if (made.has(lod))
        for (const DerivedLevels::Voxel& v : made.level(lod))
          count_in_tiles(tiling, lod, {v.at, {v.at[0] + 1, v.at[1] + 1, v.at[2] + 1}}, of_thread[0]);
  });
  TileWeights& of_rank = of_thread[0];
  for (std::size_t t = 1; t < of_thread.size(); ++t)
    for (const auto& [tile, weight] : of_thread[t]) of_rank[tile] += weight;
  TileWeights all;
  for (const std::vector<std::uint8_t>& bytes : team_.exchange(bytes_of_tiles(of_rank))) add_tiles(bytes, all);
  if (owners_.has_overviews()) expect_whole_levels(all, tiling);
  return all;
}

void TileStats::expect_whole_levels(const TileWeights& tiles, const VoxelTiling& tiling) const {
  for (const auto& [tile, weight] : tiles)
    if (tile.level > 0 && !tiles.contains({tile.level - 1, tile.key >> 3}))
      throw InputError(scene_.file(), "PagedOctTree",
                       fmt::format("no overview has lod {} where there is lod {}; bake again to create it",
                                   tiling.lod(tile.level) + 1, tiling.lod(tile.level)));
}

}  // namespace gigabake
