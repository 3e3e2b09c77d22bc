/// The sums of a brick are exact for any number of fragments, and start from zero for the next brick.
#include "kernels/cpu/voxelize/brick_sums.h"

#include <gtest/gtest.h>

namespace gigabake::kernels {
namespace {

const Tables host_tables = TableStore::host().view();

Fragment fragment(std::int64_t weight, std::uint16_t red, std::uint16_t alpha) {
  const std::uint16_t rgba[4] = {red, 0, 0, alpha};
  return fragment_of_colour(weight, rgba, {0, 0, 32767}, 0);
}

Level resolved(BrickSums& sums) {
  std::vector<BrickRun> runs(1);
  sums.resolve_to(runs[0], 0, host_tables);
  Level level;
  append(level, runs, ThreadPool(1));
  return level;
}

/// The largest plane section of a voxel is √2 voxel²; its weight with full colour is closest to 2^63.
TEST(BrickSums, TakeAnyNumberOfTheHeaviestFragments) {
  constexpr std::int64_t heaviest = 97184015999;  // √2 · 2^36
  BrickSums sums;
  for (int i = 0; i < 100000; ++i) {
    sums.add(77, fragment(heaviest, i % 4 == 0 ? 65535 : 0, 65535));
    sums.end_triangle();
  }
  const Level level = resolved(sums);
  ASSERT_EQ(level.rgba.size(), 4u);
  EXPECT_EQ(level.rgba[0], host_tables.srgb_from_linear[16384]);  // a quarter
  EXPECT_EQ(level.rgba[3], 255);
}

TEST(BrickSums, AreTheSameBeforeAndAfterMovingToWideOnes) {
  for (const int count : {fragments_before_flush - 1, fragments_before_flush, 3 * fragments_before_flush + 1}) {
    BrickSums sums;
    for (int i = 0; i < count; ++i) {
      sums.add(5, fragment(1000, 30000, 40000));
      sums.end_triangle();
    }
    const Level level = resolved(sums);
    EXPECT_EQ(level.rgba[0], host_tables.srgb_from_linear[49151]) << count;  // 30000 / 40000
    EXPECT_EQ(level.rgba[3], 156) << count;                                  // 40000 / 65535
  }
}

TEST(BrickSums, StartTheNextBrickFromZero) {
  BrickSums sums;
  for (int i = 0; i < 2 * fragments_before_flush; ++i) {
    sums.add(9, fragment(1000, 65535, 65535));
    sums.end_triangle();
  }
  resolved(sums);
  sums.add(9, fragment(1000, 0, 65535));
  sums.end_triangle();
  EXPECT_EQ(resolved(sums).rgba, (std::vector<std::uint8_t>{0, 0, 0, 255}));
}

/// Returns the alpha of a voxel with these fragments (weight, alpha), in this order.
int alpha_of(const std::vector<std::pair<std::int64_t, std::uint16_t>>& fragments) {
  BrickSums sums;
  for (const auto& [weight, alpha] : fragments) {
    sums.add(7, fragment(weight, 0, alpha));
    sums.end_triangle();
  }
  const Level level = resolved(sums);
  return level.rgba.empty() ? 0 : level.rgba[3];
}

/// 2026-11-26: a mean over all fragments made the ground below grass, decals and glass translucent.
TEST(BrickSums, AreOpaqueWithOneOpaqueFragmentWhateverElseTheVoxelHas) {
  EXPECT_EQ(alpha_of({{1, 65535}, {1000000, 1}, {1000000, 0}, {1000000, 40000}}), 255);
  EXPECT_EQ(alpha_of({{1000000, 0}, {1000000, 65534}, {1, 65535}}), 255);
  std::vector<std::pair<std::int64_t, std::uint16_t>> many(2 * fragments_before_flush, {1000000, 100});
  many[1] = {1, 65535};
  EXPECT_EQ(alpha_of(many), 255);
}

TEST(BrickSums, HaveTheMeanAlphaOfFragmentsIfNoneIsOpaque) {
  EXPECT_EQ(alpha_of({{1000, 40000}}), 156);
  EXPECT_EQ(alpha_of({{1000, 40000}, {1000, 0}}), 78);
  EXPECT_EQ(alpha_of({{1000, 65534}}), 255);
  EXPECT_EQ(alpha_of({{1000, 65534}, {1000, 0}}), 127);
  EXPECT_EQ(alpha_of({{1000000, 0}}), 0);
}

/// Regression of 2026-11-27: the arrays of a level were sized by its first run, which may have no brick.
TEST(BrickRuns, MayBeEmptyBeforeARunWithPlanes) {
  std::vector<BrickRun> runs(3, BrickRun(true, true));
  BrickSums sums;
  sums.add(7, fragment(1 << 30, 65535, 65535));
  sums.end_triangle();
  sums.resolve_to(runs[1], 0, host_tables);
  Level level;
  append(level, runs, ThreadPool(1));
  EXPECT_EQ(level.directional_coverage.size(), directional_coverage_bytes);
  EXPECT_EQ(level.directional_coverage[directional_coverage_plane], 8 << 2 | 3);  // through the voxel's centre
}

TEST(BrickSums, LeaveOutABrickOfInvisibleVoxels) {
  BrickSums sums;
  sums.add(3, fragment(1000, 0, 100));
  sums.end_triangle();
  EXPECT_TRUE(resolved(sums).key.empty());
}

}  // namespace
}  // namespace gigabake::kernels
