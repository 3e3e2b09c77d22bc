// Reads parts of damaged shards, and of invalid shards with correct checksums. The result is an error, or an answer
// that satisfies the contract.
#include <bit>
#include <gtest/gtest.h>
#include <random>

#include "core/base/error.h"
#include "damaged_file.h"
#include "format/shard/shard_pages.h"
#include "made_shard.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using made::TempFolder;

void append(std::vector<NodeRow>& to, const std::vector<NodeRow>& rows) {
  to.insert(to.end(), rows.begin(), rows.end());
}

/// Returns the shard assembled from small parts. Keys and lods come from `written`, because parts do not store them.
Shard put_together(const ShardPages& pages, const Shard& written) {
  Shard s{pages.header(), {}, {}};
  std::vector<NodeRow> rows;
  for (std::uint64_t row = 0; row < pages.node_rows(); row += 5) append(rows, pages.nodes(row, 5));
  s.nodes.key = written.nodes.key;
  s.nodes.lod = written.nodes.lod;
  for (const NodeRow& row : rows) {
    s.nodes.kind.push_back(row.kind);
    s.nodes.child_mask.push_back(row.child_mask);
    s.nodes.first_child.push_back(row.first_child);
    s.nodes.value.push_back(row.value);
    s.nodes.normal.push_back({row.normal[0], row.normal[1]});
    if (s.header.has_directional_coverage)
      s.nodes.directional_coverage.push_back(std::to_array(row.directional_coverage));
    if (s.header.has_classes) s.nodes.voxel_class.push_back(row.voxel_class);
  }
  s.nodes.has_finest_planes = s.header.has_directional_coverage && s.header.has_normals && s.header.first_lod == 0;
  for (int lod = 0; lod < int(s.header.lods); ++lod) {
    BrickLevel& level = s.levels.emplace_back();
    level.first = {0};
    for (std::uint64_t b = 0; b < pages.bricks(lod); b += 2) {
      const BrickBlock block = pages.level(lod, b, 2);
      const std::uint64_t begin = level.first.back();
      for (std::size_t i = 1; i < block.first.size(); ++i) level.first.push_back(begin + block.first[i]);
      level.mask.insert(level.mask.end(), block.mask.begin(), block.mask.end());
      level.rgba.insert(level.rgba.end(), block.rgba.begin(), block.rgba.end());
      level.normal.insert(level.normal.end(), block.normal.begin(), block.normal.end());
      level.directional_coverage.insert(level.directional_coverage.end(), block.directional_coverage.begin(),
                                        block.directional_coverage.end());
      level.voxel_class.insert(level.voxel_class.end(), block.voxel_class.begin(), block.voxel_class.end());
    }
  }
  return s;
}

/// Expects an error or exactly the shard that was written.
void expect_error_or_equal_pages(const std::filesystem::path& path, const Shard& written, const std::string& what) {
  try {
    EXPECT_EQ(made::difference(written, put_together(ShardPages(path), written)), "") << what;
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << what << ": " << error.what();
  }
}

TEST(HostileShardPages, WithAnyByteChangedAreAnErrorOrReadAsBefore) {
  const TempFolder folder;
  const Shard shard = made::small_shard();
  write_shard(folder / "s.h5", shard, {});
  made::for_each_changed_byte(folder / "s.h5", test::RandomSeed(), [&](const std::string& what) {
    expect_error_or_equal_pages(folder / "s.h5", shard, what);
  });
}

TEST(HostileShardPages, WithAnOverwrittenStretchAreAnErrorOrReadAsBefore) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  const Shard shard = made::with_classes(made::random_shard(rng, {3, true, 3, rng() % 2 == 0}));
  write_shard(folder / "s.h5", shard, {});
  made::for_each_overwritten_stretch(folder / "s.h5", seed, [&](const std::string& what) {
    expect_error_or_equal_pages(folder / "s.h5", shard, what);
  });
}

TEST(HostileShardPages, CutAnywhereAreAnError) {
  const TempFolder folder;
  const Shard shard = made::small_shard();
  write_shard(folder / "s.h5", shard, {});
  made::for_each_cut(folder / "s.h5", [&](const std::string& what) {
    EXPECT_THROW(put_together(ShardPages(folder / "s.h5"), shard), InputError) << what;
  });
}

TEST(HostileShardPages, CutWhileTheFileIsOpenAreAnError) {
  const TempFolder folder;
  const Shard shard = made::small_shard();
  write_shard(folder / "s.h5", shard, {});
  const ShardPages pages(folder / "s.h5");
  EXPECT_EQ(pages.nodes(0, 3).size(), 3u);
  EXPECT_EQ(pages.level(0, 0, 1).first.size(), 2u);
  std::filesystem::resize_file(folder / "s.h5", 100);
  EXPECT_THROW(pages.nodes(0, 3), InputError);
  EXPECT_THROW(pages.level(0, 0, 1), InputError);
}

/// Changes one number of the shard; the file is complete and its checksums are correct.
void tell_a_lie(std::mt19937_64& rng, Shard& s) {
  const auto lie_in = [&](auto& values) {
    if (values.empty()) return;
    auto& value = values[rng() % values.size()];
    using Value = std::remove_reference_t<decltype(value)>;
    const std::uint64_t old = std::uint64_t(value), any[] = {old + 1, old - 1, old ^ 1u << rng() % 8, 0, ~0ull, rng()};
    value = Value(any[rng() % 6]);
  };
  switch (rng() % 6) {
    case 0:
      return lie_in(s.nodes.lod);
    case 1:
      return lie_in(s.nodes.kind);
    case 2:
      return lie_in(s.nodes.child_mask);
    case 3:
      return lie_in(s.nodes.first_child);
    case 4:
      return lie_in(s.nodes.value);
    default:
      return lie_in(s.levels[rng() % s.levels.size()].rgba);
  }
}

void expect_sound(const std::vector<NodeRow>& rows, std::uint64_t first, const ShardPages& pages) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto children = std::uint64_t(std::popcount(rows[i].child_mask));
    EXPECT_LE(rows[i].kind, NodeKind::leaf_constant);
    if (children == 0) continue;
    EXPECT_GT(rows[i].first_child, first + i);
    EXPECT_LE(rows[i].first_child + children, pages.node_rows());
  }
}

void expect_sound(const BrickBlock& block) {
  ASSERT_FALSE(block.first.empty());
  const std::size_t bricks = block.first.size() - 1;
  ASSERT_EQ(block.mask.size(), 8 * bricks);
  EXPECT_EQ(block.first[0], 0u);
  for (std::size_t b = 0; b < bricks; ++b) {
    int bits = 0;
    for (std::size_t w = 0; w < 8; ++w) bits += std::popcount(block.mask[8 * b + w]);
    EXPECT_EQ(block.first[b + 1] - block.first[b], std::uint32_t(bits));
  }
  EXPECT_EQ(block.rgba.size(), 4 * std::size_t(block.first.back()));
  EXPECT_EQ(block.normal.size(), 2 * std::size_t(block.first.back()));
}

template <class Read>
void expect_answer_or_error(const Read& read) {
  try {
    read();
  } catch (const InputError&) {  // refused, which is as good as a valid answer
  }
}

TEST(HostileShardPages, ThatLieUnderRightChecksumsAreRefusedOrKeepTheirPromises) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  const Shard honest = made::random_shard(rng, {4, true, 4, rng() % 2 == 0});
  for (int round = 0; round < 200 && !testing::Test::HasFailure(); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    Shard shard = honest;
    for (std::uint64_t lies = 1 + rng() % 3; lies > 0; --lies) tell_a_lie(rng, shard);
    write_shard(folder / "s.h5", shard, {});
    const ShardPages pages(folder / "s.h5");
    for (std::uint64_t row = 0; row < shard.nodes.key.size(); row += 16)
      expect_answer_or_error([&] { expect_sound(pages.nodes(row, 16), row, pages); });
    for (int lod = 0; lod < 4; ++lod)
      for (std::uint64_t b = 0; b < shard.levels[std::size_t(lod)].mask.size() / 8; b += 4)
        expect_answer_or_error([&] { expect_sound(pages.level(lod, b, 4)); });
  }
}

}  // namespace
}  // namespace gigabake
