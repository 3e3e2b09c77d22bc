#include "lattice/morton.h"

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

}  // namespace
}  // namespace gigabake::kernels
