#include "format/shard/levels/above.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "format/shard/levels/content_hash.h"
#include "format/shard/shard_reader.h"
#include "made_shard.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

Shard shard_with(DownsampleState above) {
  Shard shard = made::small_shard_with_planes();
  shard.above = std::move(above);
  return shard;
}

TEST(Above, ComesBackAsItWasWrittenWithEveryCodecAndWithoutChannels) {
  const made::TempFolder folder;
  Shard shard = shard_with(made::small_above());
  for (const Codec codec : values_of<Codec>()) {
    write_shard(folder / "s.h5", shard, {callers_thread(), codec});
    EXPECT_EQ(ShardReader(folder / "s.h5").above(), shard.above);
    EXPECT_EQ(read_shard(folder / "s.h5").above, shard.above);
  }
  shard.above.raster.clear(), shard.above.patch.clear();
  write_shard(folder / "s.h5", shard, {});
  EXPECT_EQ(ShardReader(folder / "s.h5").above(), shard.above);
  shard.above = {};
  write_shard(folder / "s.h5", shard, {});
  EXPECT_TRUE(ShardReader(folder / "s.h5").above().empty());
}

TEST(Above, IsRefusedWhereARuleIsBroken) {
  const made::TempFolder folder;
  const auto expect_refused = [&](const char* what, const auto& breaks) {
    DownsampleState above = made::small_above();
    breaks(above);
    write_shard(folder / "s.h5", shard_with(above), {});
    EXPECT_THROW(ShardReader(folder / "s.h5").above(), InputError) << what;
    EXPECT_EQ(ShardReader(folder / "s.h5").unreadable_columns().size(), 1u) << what;
  };
  expect_refused("position outside", [](DownsampleState& a) { a.place[5] = 8; });
  expect_refused("level 2", [](DownsampleState& a) { a.place[4] = 2; });
  expect_refused("coarsest last", [](DownsampleState& a) { a.place[0] = 1; });
  expect_refused("no coverage", [](DownsampleState& a) { a.rgba[7] = 0; });
  expect_refused("a place more", [](DownsampleState& a) { a.place.insert(a.place.end(), {0, 1, 1, 1}); });
  expect_refused("a normal less", [](DownsampleState& a) { a.normal.resize(2); });
  expect_refused("a raster less", [](DownsampleState& a) { a.raster.resize(12); });
  expect_refused("a patch more", [](DownsampleState& a) { a.patch.resize(24); });
}

TEST(Above, HashIsOfEveryByte) {
  const test::RandomSeed seed;
  std::mt19937_64 random{seed};
  const DownsampleState above = made::small_above();
  for (int round = 0; round < 50; ++round) {
    DownsampleState other = above;
    switch (random() % 4) {
      case 0:
        ++other.place[random() % other.place.size()];
        break;
      case 1:
        ++other.rgba[random() % other.rgba.size()];
        break;
      case 2:
        ++other.raster[random() % other.raster.size()];
        break;
      default:
        ++other.patch[random() % other.patch.size()];
    }
    EXPECT_NE(hash_of(other), hash_of(above));
  }
}

/// Returns an overview of 512³ lod-0 voxels. Its levels 0 and 1 are levels 5 and 6 of the scene.
Shard small_overview() {
  Shard overview = made::small_shard_with_planes(5);
  overview.header.first_lod = 5;
  overview.header.copied_lods = 1;
  overview.header.cell_voxels <<= 5;
  overview.header.lattice_min = {-512, 1024, 64};
  NodeTable& n = overview.nodes;  // without the constant node, which only a cell may have
  n.key.pop_back(), n.lod.pop_back(), n.kind.pop_back(), n.child_mask = {1, 0}, n.first_child.pop_back();
  n.value.pop_back(), n.normal.pop_back(), n.directional_coverage.pop_back();
  for (std::size_t b = 0; b < overview.levels[0].rgba.size() / 4; ++b)
    overview.levels[0].directional_coverage.insert(overview.levels[0].directional_coverage.end(), {7, 8, 9, 0x1a});
  return overview;
}

TEST(OverviewShard, HasFacingOnItsFinestLevelAndItsLevelsPlaceOnTheLattice) {
  const made::TempFolder folder;
  Shard overview = small_overview();
  overview.header.content_hash = content_hash(overview);
  write_shard(folder / "p.h5", overview, {});
  const ShardReader reader(folder / "p.h5");
  EXPECT_EQ(reader.header().first_lod, 5u);
  EXPECT_EQ(reader.header().copied_lods, 1u);
  EXPECT_EQ(reader.level(0).directional_coverage, overview.levels[0].directional_coverage);
  Shard cell = overview;
  cell.header.first_lod = cell.header.copied_lods = 0;
  EXPECT_NE(content_hash(cell), overview.header.content_hash);
}

TEST(OverviewShard, IsRefusedOffItsGridAndOfAnotherNumberOfLevels) {
  const made::TempFolder folder;
  const auto expect_refused = [&](const auto& breaks) {
    Shard overview = small_overview();
    breaks(overview.header);
    write_shard(folder / "p.h5", overview, {});
    EXPECT_THROW(read_shard_header(folder / "p.h5"), InputError);
  };
  expect_refused([](ShardHeader& h) { h.lattice_min[2] = 32; });
  expect_refused([](ShardHeader& h) { h.first_lod = 4; });
  expect_refused([](ShardHeader& h) { h.first_lod = 40; });
  expect_refused([](ShardHeader& h) { h.cell_voxels = 1u << 31; });
  expect_refused([](ShardHeader& h) { h.copied_lods = h.lods; });
  expect_refused([](ShardHeader& h) {
    h.cell_voxels >>= h.first_lod;
    h.first_lod = 0;  // a cell, which has no duplicated levels
  });
}

}  // namespace
}  // namespace gigabake
