#include "format/shard/levels/level_summary.h"

#include <gtest/gtest.h>

namespace gigabake {
namespace {

TEST(LevelSummary, CountsBricksAndWhatConstantNodesStandFor) {
  Shard shard;
  shard.levels.resize(3);
  shard.levels[0].rgba = {0, 0, 0, 1, 0, 0, 0, 63, 0, 0, 0, 64, 0, 0, 0, 255};
  shard.nodes.kind = {NodeKind::constant, NodeKind::leaf_constant, NodeKind::brick};
  shard.nodes.lod = {2, 1, 0};
  shard.nodes.value = {0xfe000000u, 0x80ffffffu, 0};
  const std::vector<LevelSummary> levels = summarize_levels(shard);
  ASSERT_EQ(levels.size(), 3u);
  EXPECT_EQ(levels[0].coverage, (std::array<std::uint64_t, 5>{2, 1, 8 * 512, 0, 1}));
  EXPECT_EQ(levels[0].alpha_sum, 1 + 63 + 64 + 255 + 128u * 8 * 512);
  EXPECT_EQ(levels[1].coverage, (std::array<std::uint64_t, 5>{0, 0, 512, 0, 0}));
  EXPECT_EQ(levels[2].coverage, (std::array<std::uint64_t, 5>{0, 0, 0, 512, 0}));
  EXPECT_EQ(levels[2].voxels(), 512u);
  EXPECT_DOUBLE_EQ(levels[2].mean_coverage(), 254.0 / 255);
}

TEST(LevelSummary, OfAnEmptyLevelHasNoMean) { EXPECT_EQ(LevelSummary().mean_coverage(), 0); }

TEST(LevelSummary, DoesNotCountCopies) {
  std::vector<LevelSummary> sum{{}, {{1, 2, 3, 4, 5}, 6, 7}};
  add_levels({{{9, 9, 9, 9, 9}, 9, 9}, {{1, 1, 1, 1, 1}, 2, 3}}, 1, 1, sum);
  EXPECT_EQ(sum, (std::vector<LevelSummary>{{}, {{1, 2, 3, 4, 5}, 6, 7}, {{1, 1, 1, 1, 1}, 2, 3}}));
}

TEST(LevelSummary, AddsUpWhereOneSceneHasMoreLevels) {
  std::vector<LevelSummary> sum{{{1, 2, 3, 4, 5}, 6, 7}};
  add_levels({{{10, 20, 30, 40, 50}, 60, 70}, {{1, 1, 1, 1, 1}, 2, 3}}, 0, 0, sum);
  EXPECT_EQ(sum, (std::vector<LevelSummary>{{{11, 22, 33, 44, 55}, 66, 77}, {{1, 1, 1, 1, 1}, 2, 3}}));
}

}  // namespace
}  // namespace gigabake
