// Columns of classes: written and read as a whole, by pages and by coarse levels.
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "format/shard/levels/coarse_levels.h"
#include "format/shard/levels/content_hash.h"
#include "format/shard/levels/level_lookup.h"
#include "format/shard/shard_pages.h"
#include "format/shard/shard_reader.h"
#include "made_shard.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

TEST(ClassColumns, AreReadAsTheyWereWritten) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (int round = 0; round < 24; ++round) {
    made::ShardShape shape;
    shape.normals = round % 2 == 0;
    shape.directional_coverage = round % 3 != 0;
    shape.nested = round % 4 < 2;
    const Shard shard = made::with_classes(made::random_shard(rng, shape));
    const made::TempFolder folder;
    write_shard(folder / "s.h5", shard, {callers_thread(), round % 5 == 0 ? Codec::lz4 : Codec::deflate});
    const Shard read = read_shard(folder / "s.h5");
    ASSERT_EQ(made::difference(read, shard), "");
    EXPECT_EQ(content_hash(read), shard.header.content_hash);
    const ShardPages pages(folder / "s.h5");
    const std::vector<NodeRow> rows = pages.nodes(0, 1u << 20);
    for (std::size_t n = 0; n < rows.size(); ++n) EXPECT_EQ(rows[n].voxel_class, shard.nodes.voxel_class[n]);
    for (int lod = 0; lod < int(shard.header.lods); ++lod) {
      const BrickLevel& level = shard.levels[std::size_t(lod)];
      const std::uint64_t bricks = level.mask.size() / 8;
      if (bricks != 0) {
        const std::uint64_t first = rng() % bricks;
        const BrickBlock block = pages.level(lod, first, 70);
        const auto begin = level.voxel_class.begin() + std::ptrdiff_t(level.first[first]);
        EXPECT_TRUE(std::equal(block.voxel_class.begin(), block.voxel_class.end(), begin));
        EXPECT_EQ(block.voxel_class.size(), block.rgba.size() / 4);
      }
      const CoarseLevels coarse = ShardReader(folder / "s.h5").coarse_levels(lod);
      EXPECT_EQ(coarse.levels.front().voxel_class, level.voxel_class);
      for (std::size_t n = 0; n < coarse.nodes.key.size(); ++n)
        EXPECT_EQ(coarse.nodes.voxel_class[n], shard.nodes.voxel_class[n]);
      LevelLookup lookup(shard.nodes, level, shard.header.lods, lod);
      for_each_voxel_of_level(shard.nodes, level, lod,
                              [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t*,
                                  const std::int8_t*, const std::uint8_t*, VoxelClass voxel_class) {
                                VoxelValue value;
                                ASSERT_TRUE(lookup.find(x, y, z, value));
                                ASSERT_EQ(value.voxel_class, voxel_class);
                              });
    }
  }
}

TEST(ClassColumns, ChangeHashesOnlyOfVoxelsWithAClass) {
  Shard shard = made::with_classes(made::small_shard_with_planes());
  const std::vector<Hash128> without = made::small_shard_with_planes().header.content_hash;
  EXPECT_NE(content_hash(shard)[0], without[0]);
  for (BrickLevel& level : shard.levels) level.voxel_class.assign(level.voxel_class.size(), no_class);
  shard.nodes.voxel_class.assign(shard.nodes.voxel_class.size(), no_class);
  EXPECT_EQ(content_hash(shard), without);
}

TEST(ClassColumns, OfAnotherLengthAreNotWritten) {
  const made::TempFolder folder;
  Shard shard = made::with_classes(made::small_shard());
  shard.levels[0].voxel_class.pop_back();
  EXPECT_THROW(write_shard(folder / "s.h5", shard, {}), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder / "s.h5"));
}

}  // namespace
}  // namespace gigabake
