#include "core/octree/morton.h"

#include <gtest/gtest.h>
#include <random>

namespace gigabake::kernels {
namespace {

TEST(Morton, InterleavesBitsWithXLowest) {
  EXPECT_EQ(morton(1, 0, 0), 1u);
  EXPECT_EQ(morton(0, 1, 0), 2u);
  EXPECT_EQ(morton(0, 0, 1), 4u);
  EXPECT_EQ(morton(2, 0, 0), 8u);
  EXPECT_EQ(morton(7, 7, 7), 511u);
}

TEST(Morton, ReturnsTheCoordinateItWasMadeOf) {
  const std::uint32_t seed = 1;
  std::mt19937 rng(seed);
  for (int i = 0; i < 10000; ++i) {
    const std::uint32_t x = rng() & 0x1fffff, y = rng() & 0x1fffff, z = rng() & 0x1fffff;
    const BrickCoordinate c = demorton(morton(x, y, z));
    ASSERT_TRUE(c.x == x && c.y == y && c.z == z) << x << ' ' << y << ' ' << z << ", seed " << seed;
  }
}

TEST(Morton, OfAParentIsTheChildsWithoutItsLastThreeBits) {
  for (std::uint32_t c = 0; c < 8; ++c)
    EXPECT_EQ(morton(2 * 11 + (c & 1), 2 * 5 + (c >> 1 & 1), 2 * 9 + (c >> 2)), morton(11, 5, 9) << 3 | c);
}

TEST(Morton, OfAColumnInterleavesAll32Bits) {
  EXPECT_EQ(morton(1, 0), 1u);
  EXPECT_EQ(morton(0, 1), 2u);
  EXPECT_EQ(morton(0xffffffff, 0), 0x5555555555555555u);
  EXPECT_EQ(morton(0, 0xffffffff), 0xaaaaaaaaaaaaaaaau);
}

TEST(Morton, ByPairsNumbersTheChildrenOfA4x4x4Tree) {
  for (std::uint32_t c = 0; c < 64; ++c)
    EXPECT_EQ(morton_by_pairs(4 * 11 + (c & 3), 4 * 5 + (c >> 2 & 3), 4 * 9 + (c >> 4)),
              morton_by_pairs(11, 5, 9) << 6 | c);
  EXPECT_EQ(morton_by_pairs(0xfffff, 0xfffff, 0xfffff), (std::uint64_t(1) << 60) - 1);
}

TEST(Morton, GathersTheLowestThreeBitsOfEachAxis) {
  for (std::uint32_t c = 0; c < 512; ++c) {
    const auto key = std::uint32_t(morton(c & 7, c >> 3 & 7, c >> 6)) | 0xfffffe00u;
    EXPECT_EQ(gather_three_bits(key), int(c & 7));
    EXPECT_EQ(gather_three_bits(key >> 1), int(c >> 3 & 7));
    EXPECT_EQ(gather_three_bits(key >> 2), int(c >> 6));
  }
}

}  // namespace
}  // namespace gigabake::kernels
