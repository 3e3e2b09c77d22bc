#include "kernels/body/mip/mip.h"

#include <gtest/gtest.h>
#include <random>

#include "kernels/body/mask.h"
#include "kernels/cpu/mip/levels.h"

namespace gigabake::kernels {
namespace {

const Tables mip_tables = TableStore::host().view();

TEST(Weights, AreAsMuchAsShowsOfEachChild) {
  CoverageSums seen;
  for (std::uint32_t c = 0; c < 8; ++c) seen.seen[c] = 6 * c;
  const std::uint32_t all[2] = {0x01010101, 0x01010101};
  const Weights w = weights_of(seen, 1, all);
  for (std::uint32_t c = 0; c < 8; ++c) EXPECT_EQ(w.of(int(c)), c);
}

TEST(Weights, AreAlikeWhereAllChildrenAreTooFaintAndNoneForThoseThatAreNotThere) {
  const std::uint32_t there[2] = {0x01000001, 0x00010000};
  const Weights w = weights_of(CoverageSums{}, 8, there);
  for (int c = 0; c < 8; ++c) EXPECT_EQ(w.of(c), c == 0 || c == 3 || c == 6 ? 1u : 0u) << c;
  EXPECT_EQ(w.max_directional_coverage(), 1u) << "what exists does not vanish";
}

TEST(Weights, ReportTheMaxFacing) {
  EXPECT_EQ((Weights{{0, 0}, 0x010203}.max_directional_coverage()), 3u);
  EXPECT_EQ((Weights{{0, 0}, 0x010302}.max_directional_coverage()), 3u);
  EXPECT_EQ((Weights{{0, 0}, 0x030201}.max_directional_coverage()), 3u);
}

TEST(ParentSlab, HasAVoxelWhereOneOfEightExists) {
  const std::uint64_t seed = 20261122;
  std::mt19937_64 random(seed);
  for (int i = 0; i < 10000; ++i) {
    const std::uint64_t low = random() & random() & random(), high = random() & random() & random();
    std::uint64_t expected = 0;
    for (int bit = 0; bit < 64; ++bit)
      if (((low | high) >> bit & 1) != 0) expected |= std::uint64_t(1) << ((bit & 7) / 2 + 8 * (bit / 16));
    ASSERT_EQ(parent_slab(low, high), expected) << "seed " << seed << ", case " << i;
  }
}

/// Returns a level with two adjacent voxels, red and blue, that have the same parent.
Level two_voxels() {
  Level level;
  level.key = {0};
  level.mask = {3, 0, 0, 0, 0, 0, 0, 0};
  level.first = {0, 2};
  level.rgba = {255, 0, 0, 1, 0, 0, 255, 1};
  level.normal = {0, 0, 0, 0};
  level.directional_coverage = {1, 1, 1, 0, 1, 1, 1, 0};
  return level;
}

// 2026-11-22: if no child had visible coverage, the CPU gave the parent the colour of the first child only. A GPU and
// the exact reference of tests/reference average all children.
TEST(Levels, TakeTheMeanOfAllChildrenWhereNothingOfAnyShows) {
  std::vector<Level> levels(5);
  levels.back() = two_voxels();
  LevelSurface rasters{std::vector<std::uint32_t>(2 * std::size_t(raster_words(max_raster_edge)), 0),
                       std::vector<SurfaceMoments>(2)};
  add_coarser_levels(levels, rasters, 6, MipFilter::coverage, true, ThreadPool(1));
  ASSERT_EQ(levels.size(), 6u);
  const std::uint8_t half = mip_tables.srgb_from_linear[(65535 + 1) / 2];
  EXPECT_EQ(levels[5].rgba, (std::vector<std::uint8_t>{half, 0, half, 1}));
}

}  // namespace
}  // namespace gigabake::kernels
