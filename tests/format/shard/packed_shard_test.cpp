// A shard written from packed columns is the same file as a shard written from voxels.
#include "format/shard/packed_shard.h"

#include <algorithm>
#include <deque>
#include <gtest/gtest.h>

#include "format/shard/levels/brick_walk.h"
#include "format/shard/levels/coarse_levels.h"
#include "format/shard/shard_reader.h"
#include "tests/format/shard/made_shard.h"
#include "tests/format/shard/packed_by_hand.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using made::PackedByHand;

void expect_same_file(const Shard& shard, PackedByHand::As as, Codec codec) {
  const made::TempFolder folder;
  const ThreadPool pool(2);
  const PackedByHand by_hand(shard, as, codec);
  const StoredShard voxels = write_shard(folder / "voxels.h5", shard, {pool, codec}),
                    packed = write_packed_shard(folder / "packed.h5", by_hand.packed, {pool, codec});
  EXPECT_TRUE(made::bytes_of(folder / "voxels.h5") == made::bytes_of(folder / "packed.h5"));
  constexpr std::uint64_t no_memory = 0;  // the file is not built in memory first
  write_packed_shard(folder / "as it goes.h5", by_hand.packed, {pool, codec, no_memory});
  EXPECT_TRUE(made::bytes_of(folder / "voxels.h5") == made::bytes_of(folder / "as it goes.h5"));
  EXPECT_EQ(voxels.file, packed.file);
  EXPECT_EQ(voxels.levels, packed.levels);
  EXPECT_EQ(summarize_levels(shard), summarize_levels(by_hand.packed));
  EXPECT_EQ(count_voxels(shard), count_voxels(by_hand.packed));
}

TEST(PackedShard, IsTheFileOfItsVoxels) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (int round = 0; round < 24; ++round) {
    made::ShardShape shape;
    shape.lods = 1 + int(rng() % 4);
    shape.normals = rng() % 2 != 0;
    shape.directional_coverage = rng() % 2 != 0;
    shape.alike = rng() % 2 != 0;
    const Shard shard = made::random_shard(rng, shape);
    const auto as = rng() % 2 != 0 ? PackedByHand::As::raw : PackedByHand::As::stored;
    expect_same_file(shard, as, rng() % 3 == 0 ? Codec::lz4 : Codec::deflate);
  }
}

/// The columns of the downsample state are never packed in advance, so their chunks are freed before the file is
/// written.
TEST(PackedShard, HoldsItsDownsampleState) {
  Shard shard = made::small_shard_with_planes();
  shard.above = made::small_above();
  for (const auto as : {PackedByHand::As::raw, PackedByHand::As::stored})
    for (const Codec codec : values_of<Codec>()) expect_same_file(shard, as, codec);
}

TEST(PackedShard, HasTheCountsOfItsVoxels) {
  const Shard shard = made::shard_of({{{1, 2, 3}, {4, 5, 6, 7}, {8, 9}}, {{40, 50, 60}, {1, 2, 3, 255}, {}}}, {}, 64);
  expect_same_file(shard, PackedByHand::As::stored, Codec::deflate);
  const std::vector<std::uint64_t> voxels = count_voxels(PackedByHand(shard, PackedByHand::As::raw, {}).packed);
  EXPECT_EQ(voxels, count_voxels(shard));
  EXPECT_EQ(voxels[0], 2u);
}

// Since 2026-11-25 overviews read their children from packed shards in memory, so these must equal the files.
TEST(PackedShard, UnpacksToTheCoarseLevelsOfItsFile) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const made::TempFolder folder;
  for (int round = 0; round < 40; ++round) {
    made::ShardShape shape;
    shape.lods = 1 + int(rng() % 4);
    shape.normals = rng() % 2 != 0;
    shape.directional_coverage = rng() % 2 != 0;
    shape.alike = rng() % 2 != 0;
    const Shard shard = made::random_shard(rng, shape);
    write_shard(folder / "shard.h5", shard, {});
    const int begin = int(rng() % std::uint64_t(shape.lods));
    const auto as = rng() % 2 != 0 ? PackedByHand::As::raw : PackedByHand::As::stored;
    const CoarseLevels packed = unpack_coarse_levels(PackedByHand(shard, as, Codec::deflate).packed, begin);
    const CoarseLevels read = ShardReader(folder / "shard.h5").coarse_levels(begin);
    for (const CoarseLevels* coarse : {&packed, &read}) {
      const NodeTable& n = coarse->nodes;
      const std::size_t rows = n.key.size();
      ASSERT_EQ(rows, std::size_t(std::ranges::count_if(shard.nodes.lod, [&](int lod) { return lod >= begin; })));
      const auto is_prefix = [rows](const auto& part, const auto& whole) {
        return part.size() == std::min(rows, whole.size()) && std::equal(part.begin(), part.end(), whole.begin());
      };
      EXPECT_TRUE(is_prefix(n.key, shard.nodes.key) && is_prefix(n.lod, shard.nodes.lod));
      EXPECT_TRUE(is_prefix(n.kind, shard.nodes.kind) && is_prefix(n.child_mask, shard.nodes.child_mask));
      EXPECT_TRUE(is_prefix(n.first_child, shard.nodes.first_child) && is_prefix(n.value, shard.nodes.value));
      EXPECT_TRUE(is_prefix(n.normal, shard.nodes.normal) &&
                  is_prefix(n.directional_coverage, shard.nodes.directional_coverage));
      ASSERT_EQ(coarse->levels.size(), shard.levels.size() - std::size_t(begin));
      for (std::size_t l = 0; l < coarse->levels.size(); ++l) {
        const BrickLevel &got = coarse->levels[l], &want = shard.levels[l + std::size_t(begin)];
        EXPECT_TRUE(got.mask == want.mask && got.first == want.first && got.rgba == want.rgba);
        EXPECT_TRUE(got.normal == want.normal && got.directional_coverage == want.directional_coverage);
      }
    }
  }
}

/// The memory of a file is reused for the next file; larger and smaller files alternate.
TEST(PackedShard, OfSeveralMegabytesIsTheFileOfItsVoxels) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (const std::int64_t height : {64, 2, 96}) {
    std::vector<made::Voxel> voxels;
    for (std::int64_t x = 0; x < 64; ++x)
      for (std::int64_t y = 0; y < 64; ++y)
        for (std::int64_t z = 0; z < height; ++z) {
          const std::uint64_t bits = rng();
          voxels.push_back({{2 * x, 2 * y, z},
                            {std::uint8_t(bits), std::uint8_t(bits >> 8), std::uint8_t(bits >> 16), 255},
                            {std::int8_t(bits >> 24), std::int8_t(bits >> 32)}});
        }
    const Shard shard = made::shard_of(voxels, {}, 128);
    const PackedByHand by_hand(shard, PackedByHand::As::stored, Codec::deflate);
    EXPECT_EQ(by_hand.packed.levels[0][LevelColumn::rgb].stored.size() > 4, height > 2);
    expect_same_file(shard, PackedByHand::As::stored, Codec::deflate);
  }
}

/// Four writers use HDF5 alternately, and each has its own memory.
TEST(PackedShard, IsTheSameFileWhereSeveralAreWrittenAtATime) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const made::TempFolder folder;
  constexpr std::size_t writers = 4, files = 6;
  std::deque<PackedByHand> packed;
  for (std::size_t w = 0; w < writers; ++w) {
    made::ShardShape shape;
    shape.lods = 1 + int(w);
    const Shard shard = made::random_shard(rng, shape);
    packed.emplace_back(shard, PackedByHand::As::stored, Codec::deflate);
    write_shard(folder / (std::to_string(w) + ".h5"), shard, {callers_thread(), Codec::deflate});
  }
  const auto name = [&](std::size_t i) { return folder / ("of " + std::to_string(i) + ".h5"); };
  ThreadPool(writers).parallel_for(writers * files, 1, [&](std::size_t i, std::size_t, int) {
    write_packed_shard(name(i), packed[i % writers].packed, {callers_thread(), Codec::deflate});
  });
  for (std::size_t i = 0; i < writers * files; ++i)
    EXPECT_TRUE(made::bytes_of(name(i)) == made::bytes_of(folder / (std::to_string(i % writers) + ".h5"))) << i;
}

TEST(PackedShard, OfLevelsWithoutBricksIsTheFileOfItsVoxelsToo) {
  expect_same_file(made::constant_shard(), PackedByHand::As::stored, Codec::deflate);
}

/// Expects the rows of a packer to have the sizes, byte planes and matches that the file's layout requires.
TEST(PackedShard, HasRowsAsItsColumnsAre) {
  const auto expect_row = [](const Hdf5Column& column, const RowShape& row) {
    EXPECT_EQ(column.row_bytes(), row.bytes) << column.name;
    EXPECT_EQ(column.shuffled_bytes(), row.shuffled_bytes) << column.name;
    EXPECT_EQ(column.min_match_bytes, row.min_match_bytes) << column.name;
  };
  ShardHeader header;
  header.has_directional_coverage = header.has_classes = true;
  const std::vector<RowShape> nodes = packed_nodes(header);
  const NodeColumns names(shard_version);
  ASSERT_EQ(nodes.size(), names.all(header).size());
  expect_row(names.key, nodes[std::size_t(NodeColumn::key)]);
  expect_row(names.lod, nodes[std::size_t(NodeColumn::lod)]);
  expect_row(names.kind, nodes[std::size_t(NodeColumn::kind)]);
  expect_row(names.child_mask, nodes[std::size_t(NodeColumn::child_mask)]);
  expect_row(names.first_child, nodes[std::size_t(NodeColumn::first_child)]);
  expect_row(names.value, nodes[std::size_t(NodeColumn::value)]);
  const std::vector<std::string> order{"key", "lod", "kind", "child_mask", "first_child", "value"};
  for (std::size_t c = 0; c < order.size(); ++c) EXPECT_EQ(names.all(header)[c].name, "/nodes/" + order[c]);
  EXPECT_EQ(level_columns(header, 1).size(), level_column_count);
  for (const LevelColumn column : level_columns(header, 1)) expect_row(level_column(1, column), row_of(column));
}

}  // namespace
}  // namespace gigabake
