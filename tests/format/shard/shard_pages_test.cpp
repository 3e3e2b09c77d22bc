#include "format/shard/shard_pages.h"

#include <algorithm>
#include <barrier>
#include <filesystem>
#include <functional>
#include <gtest/gtest.h>
#include <memory>
#include <thread>

#include "broken_shards.h"
#include "core/base/error.h"
#include "core/base/work_counts.h"
#include "format/shard/hdf5/chunk_cache.h"
#include "made_shard.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using made::TempFolder;

/// Returns the first difference between `rows` and the rows of the table from `first` on, or an empty string.
std::string difference(const std::vector<NodeRow>& rows, const NodeTable& n, std::size_t first) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const NodeRow& row = rows[i];
    const std::size_t at = first + i;
    if (row.first_child != n.first_child[at] || row.value != n.value[at] || row.kind != n.kind[at] ||
        row.child_mask != n.child_mask[at] || row.normal[0] != n.normal[at][0] || row.normal[1] != n.normal[at][1])
      return "row " + std::to_string(at) + " differs";
    if (!n.directional_coverage.empty() &&
        !std::equal(row.directional_coverage, row.directional_coverage + directional_coverage_bytes,
                    n.directional_coverage[at].begin()))
      return "row " + std::to_string(at) + " faces otherwise";
  }
  return "";
}

template <class T>
bool same(const std::vector<T>& part, const std::vector<T>& whole, std::size_t first, std::size_t count) {
  return part.size() == count && std::equal(part.begin(), part.end(), whole.begin() + std::ptrdiff_t(first));
}

std::string difference(const BrickBlock& block, const BrickLevel& level, std::size_t first, std::size_t bricks) {
  if (block.first.size() != bricks + 1) return "the number of bricks differs";
  const std::size_t begin = level.first[first], voxels = level.first[first + bricks] - begin;
  for (std::size_t b = 0; b <= bricks; ++b)
    if (begin + block.first[b] != level.first[first + b]) return "first differs at brick " + std::to_string(first + b);
  if (!same(block.mask, level.mask, 8 * first, 8 * bricks)) return "masks differ";
  if (!same(block.rgba, level.rgba, 4 * begin, 4 * voxels)) return "colours differ";
  if (!same(block.directional_coverage, level.directional_coverage, directional_coverage_bytes * begin,
            level.directional_coverage.empty() ? 0 : directional_coverage_bytes * voxels))
    return "facing differs";
  if (!same(block.normal, level.normal, 2 * begin, level.normal.empty() ? 0 : 2 * voxels)) return "normals differ";
  return "";
}

/// Reads a random range of the shard and compares it with the values that were written.
void expect_random_range(const ShardPages& pages, const Shard& shard, std::mt19937_64& rng, const std::string& what) {
  const auto count = std::uint32_t(1 + rng() % 700);
  const std::size_t lod = rng() % (shard.levels.size() + 1);
  if (lod == shard.levels.size()) {
    const std::size_t all = shard.nodes.key.size(), first = rng() % all;
    const std::vector<NodeRow> rows = pages.nodes(first, count);
    EXPECT_EQ(rows.size(), std::min<std::size_t>(count, all - first)) << what;
    EXPECT_EQ(difference(rows, shard.nodes, first), "") << what;
    return;
  }
  const BrickLevel& level = shard.levels[lod];
  const std::size_t all = level.mask.size() / 8, first = all == 0 ? 0 : rng() % all;
  EXPECT_EQ(pages.bricks(int(lod)), all) << what;
  if (all == 0) {
    EXPECT_THROW(pages.level(int(lod), 0, count), InputError) << what;
    return;
  }
  EXPECT_EQ(difference(pages.level(int(lod), first, count), level, first, std::min<std::size_t>(count, all - first)),
            "")
      << what << ", lod " << lod << ", brick " << first;
}

TEST(ShardPages, GiveForAnyRangeThatPartOfTheWhole) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  for (int round = 0; round < 24; ++round) {
    const Shard shard = made::random_shard(rng, {1 + round % 5, round % 3 != 0, 1 + round % 8});
    write_shard(folder / "s.h5", shard, {});
    // A third of the rounds have no cache, a third a cache that holds nothing, and a third one that holds all chunks.
    const auto chunks = round % 3 == 0 ? nullptr : std::make_shared<ChunkCache>(round % 3 == 1 ? 0 : 1u << 30);
    const ShardPages pages(folder / "s.h5", chunks);
    EXPECT_EQ(made::difference({shard.header, {}, {}}, {pages.header(), {}, {}}), "");
    EXPECT_EQ(pages.node_rows(), shard.nodes.key.size());
    for (int range = 0; range < 40; ++range) expect_random_range(pages, shard, rng, "round " + std::to_string(round));
  }
}

/// Returns a shard with columns of several chunks and with more rows than one entry of ShardOutline covers.
Shard large_shard(std::mt19937_64& rng) {
  Shard shard;
  do shard = made::random_shard(rng, {8, true, 8});
  while (shard.levels[0].rgba.size() < std::size_t(1) << 20 || shard.nodes.key.size() < 20000);
  return shard;
}

TEST(ShardPages, GiveTheSameWhereColumnsHaveManyChunksAndManyThreadsReadThem) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  const Shard shard = large_shard(rng);
  write_shard(folder / "s.h5", shard, {ThreadPool(2)});
  for (const auto& chunks : {std::shared_ptr<ChunkCache>(), std::make_shared<ChunkCache>(1u << 20)}) {
    const ShardPages pages(folder / "s.h5", chunks);
    std::vector<std::jthread> readers;
    for (int t = 0; t < 4; ++t)
      readers.emplace_back([&, t] {
        std::mt19937_64 own(seed + std::uint64_t(t));
        for (int range = 0; range < 200; ++range)
          expect_random_range(pages, shard, own,
                              "seed " + std::to_string(std::uint64_t(seed)) + ", thread " + std::to_string(t));
      });
  }
}

TEST(ShardPages, ReadEachChunkOnceIfACacheHoldsAll) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  const Shard shard = large_shard(rng);
  write_shard(folder / "s.h5", shard, {ThreadPool(2)});
  const auto read_bytes = [&](const std::shared_ptr<ChunkCache>& chunks) {
    const WorkCounts before = work_counts();
    const ShardPages pages(folder / "s.h5", chunks);
    for (std::uint64_t brick = 0; brick < pages.bricks(0); brick += 64) pages.level(0, brick, 64);
    return work_counts().since(before)[WorkCounter::shard_bytes_read];
  };
  const std::uint64_t kept = read_bytes(std::make_shared<ChunkCache>(1u << 30));
  EXPECT_LE(kept, std::filesystem::file_size(folder / "s.h5"));
  EXPECT_LT(2 * kept, read_bytes(nullptr));
}

TEST(ShardPages, DecodeParentsOnceForAllThreads) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  Shard shard;
  do shard = made::random_shard(rng, {.lods = 7, .nested = true});  // one block of parents per level
  while (shard.levels[0].mask.size() < std::size_t(8) * 300 || shard.levels[1].mask.size() > std::size_t(8) * 512);
  write_shard(folder / "s.h5", shard, {});
  const auto read_rows = [&](std::size_t threads) {
    const WorkCounts before = work_counts();
    const ShardPages pages(folder / "s.h5");
    std::barrier start{std::ptrdiff_t(threads)};
    std::vector<std::jthread> readers;
    for (std::size_t t = 0; t < threads; ++t)
      readers.emplace_back([&, t] {
        start.arrive_and_wait();
        for (std::uint64_t brick = 64 * t; brick < pages.bricks(0); brick += 64 * threads) pages.level(0, brick, 64);
      });
    readers.clear();
    return work_counts().since(before)[WorkCounter::shard_rows_read];
  };
  EXPECT_EQ(read_rows(8), read_rows(1));
}

TEST(ShardPages, OfAConstantCellHaveOneNodeAndNoBricks) {
  const TempFolder folder;
  const Shard shard = made::constant_shard();
  write_shard(folder / "s.h5", shard, {});
  const ShardPages pages(folder / "s.h5");
  EXPECT_EQ(difference(pages.nodes(0, 4096), shard.nodes, 0), "");
  EXPECT_EQ(pages.bricks(0) + pages.bricks(1), 0u);
  EXPECT_THROW(pages.level(0, 0, 1), InputError);
}

TEST(ShardPages, SayWhatTheCellDoesNotHave) {
  const TempFolder folder;
  write_shard(folder / "s.h5", made::small_shard(), {});
  const ShardPages pages(folder / "s.h5");
  EXPECT_THROW(pages.nodes(3, 1), InputError);
  EXPECT_THROW(pages.nodes(~std::uint64_t(0), 4096), InputError);
  EXPECT_THROW(pages.level(0, 1, 1), InputError);
  EXPECT_THROW(pages.level(2, 0, 1), InputError);
  EXPECT_THROW(pages.level(-1, 0, 1), InputError);
  EXPECT_THROW(pages.bricks(2), InputError);
  EXPECT_THROW(ShardPages(folder / "absent.h5"), InputError);
  EXPECT_EQ(pages.nodes(2, 4096).size(), 1u);
}

/// Returns the error message when a shard that breaks a rule is written and then read part by part.
std::string told_of_pages(const std::filesystem::path& path, const std::function<void(Shard&)>& spoil) {
  Shard shard = made::small_shard();
  spoil(shard);
  write_shard(path, shard, {});
  try {
    const ShardPages pages(path);
    for (std::uint64_t row = 0; row < pages.node_rows(); ++row) pages.nodes(row, 1);
    for (int lod = 0; lod < int(pages.header().lods); ++lod)
      for (std::uint64_t b = 0; b < pages.bricks(lod); ++b) pages.level(lod, b, 1);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ShardPages, AreRefusedWhereTheyDoNotFitTheRest) {
  const TempFolder folder;
  std::vector<made::BrokenShard> cases = made::broken_shards();
  const std::vector<made::BrokenShard> more = {
      {"columns differ in length", [](Shard& s) { s.nodes.child_mask.pop_back(); }},
      {"lod does not follow its parent's lod", [](Shard& s) { s.nodes.lod[0] = 0; }},
      {"lod does not follow its parent's lod", [](Shard& s) { s.nodes.lod[2] = 1; }},
      {"first_child is out of order", [](Shard& s) { s.nodes.first_child[0] = 0; }},
      {"first_child without children", [](Shard& s) { s.nodes.first_child[1] = 0; }},
      {"a leaf has children", [](Shard& s) { s.nodes.kind[0] = NodeKind::leaf_constant; }},
      {"children are missing", [](Shard& s) { s.nodes.child_mask[0] = 0; }},
  };
  cases.insert(cases.end(), more.begin(), more.end());
  EXPECT_EQ(told_of_pages(folder / "s.h5", [](Shard&) {}), "");
  for (const auto& c : cases)
    EXPECT_NE(told_of_pages(folder / "s.h5", c.spoil).find(c.rule), std::string::npos) << c.rule;
}

}  // namespace
}  // namespace gigabake
