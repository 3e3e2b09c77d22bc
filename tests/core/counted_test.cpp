#include "core/base/counted.h"

#include <gtest/gtest.h>

namespace gigabake {
namespace {

TEST(Counted, IsThePluralOfAllNumbersButOne) {
  EXPECT_EQ(counted(0, "cell"), "0 cells");
  EXPECT_EQ(counted(1, "cell"), "1 cell");
  EXPECT_EQ(counted(2, "cell"), "2 cells");
  EXPECT_EQ(counted(21, "cell"), "21 cells");
  EXPECT_EQ(counted(~std::uint64_t(0), "voxel"), "18446744073709551615 voxels");
}

TEST(Counted, TakesAPluralThatIsMoreThanAnS) {
  EXPECT_EQ(counted(1, "more loss", "more losses"), "1 more loss");
  EXPECT_EQ(counted(3, "more loss", "more losses"), "3 more losses");
  EXPECT_EQ(counted(1, "source is", "sources are"), "1 source is");
  EXPECT_EQ(counted(0, "source is", "sources are"), "0 sources are");
}

}  // namespace
}  // namespace gigabake
