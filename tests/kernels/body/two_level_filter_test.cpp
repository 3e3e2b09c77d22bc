#include "kernels/body/mip/two_level_filter.h"

#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "core/octree/morton.h"

namespace gigabake::kernels {
namespace {

const Tables tables_of_64 = TableStore::host().view();

/// Fills a mask that is sparse or dense, at random.
void random_mask(std::mt19937_64& random, std::uint64_t mask[8]) {
  for (int w = 0; w < 8; ++w) mask[w] = random() & (random() % 2 != 0 ? random() : random() & random());
}

bool is_in(const std::uint64_t mask[8], int x, int y, int z) { return (mask[z] >> (x + 8 * y) & 1) != 0; }

TEST(MipOf64, IsWhatTheThesisMakesOfTwoLevelsFromLevelTwoOn) {
  for (int lod = 1; lod < 10; ++lod) {
    EXPECT_EQ(is_of_64(MipFilter::thesis, lod), lod >= 2);
    EXPECT_FALSE(is_of_64(MipFilter::coverage, lod));
    EXPECT_FALSE(is_of_64(MipFilter::box, lod));
  }
}

TEST(MipOf64, SumsEachVoxelOfAnOctantOnceAndNoOther) {
  const std::uint64_t seed = 20261123;
  std::mt19937_64 random(seed);
  for (int i = 0; i < 500; ++i) {
    std::uint64_t mask[8];
    random_mask(random, mask);
    std::vector<int> octants;  // octant of each voxel of the brick, in order
    for (int at = 0; at < 512; ++at)
      if (is_in(mask, at % 8, at / 8 % 8, at / 64)) octants.push_back(at % 8 / 4 + 2 * (at / 32 % 2) + 4 * (at / 256));
    for (int octant = 0; octant < 8; ++octant) {
      std::vector<int> visits(octants.size());
      const std::size_t first = 1000;
      for_each_of_64(mask, octant, first, [&](std::size_t at) { ++visits.at(at - first); });
      bool any = false;
      for (std::size_t v = 0; v < octants.size(); ++v) {
        ASSERT_EQ(visits[v], octants[v] == octant ? 1 : 0) << "seed " << seed << ", case " << i;
        any = any || octants[v] == octant;
      }
      ASSERT_EQ(has_voxels(mask, octant), any) << "seed " << seed << ", case " << i;
    }
  }
}

TEST(MipOf64, StandsWhereItsOctantLies) {
  for (std::uint32_t z = 0; z < 8; ++z)
    for (std::uint32_t y = 0; y < 8; ++y)
      for (std::uint32_t x = 0; x < 8; ++x) {
        const std::uint64_t brick = morton(4 * 5 + x / 2, 4 * 6 + y / 2, 4 * 7 + z / 2);
        EXPECT_EQ(grandparent_key(brick), morton(5, 6, 7));
        EXPECT_EQ(grandparent_voxel(brick, int(x % 2 + 2 * (y % 2) + 4 * (z % 2))), int(x + 8 * y + 64 * z));
      }
}

/// One red voxel and eight blue voxels have the weights 1 : 8. If each of the eight children were filtered first, the
/// weights would be .16 : 1.
TEST(MipOf64, WeighsVoxelsByTheirAlphaAlone) {
  const std::uint64_t mask[8] = {0x0c0c0001, 0x0c0c0000, 0, 0, 0, 0, 0, 0};
  const auto red_then_blue = [](std::size_t i) {
    return i == 0 ? Voxel{{255, 0, 0, 255}, {127, 0}} : Voxel{{0, 0, 255, 255}, {127, 0}};
  };
  const Voxel v = two_level_filter(mask, 0, 0, red_then_blue, tables_of_64);
  EXPECT_EQ(v.rgba[0], tables_of_64.srgb_from_linear[(65535 + 4) / 9]);
  EXPECT_EQ(v.rgba[1], 0);
  EXPECT_EQ(v.rgba[2], tables_of_64.srgb_from_linear[(8 * 65535 + 4) / 9]);
  EXPECT_EQ(v.rgba[3], 47) << "255 (9/64)^(55/64) = 47.2";
  EXPECT_EQ(v.normal[0], 127);
  EXPECT_EQ(v.normal[1], 0);
}

}  // namespace
}  // namespace gigabake::kernels
