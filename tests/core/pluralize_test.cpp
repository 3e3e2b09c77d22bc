#include "core/base/pluralize.h"

#include <gtest/gtest.h>

namespace gigabake {
namespace {

TEST(Counted, IsThePluralOfAllNumbersButOne) {
  EXPECT_EQ(pluralize(0, "cell"), "0 cells");
  EXPECT_EQ(pluralize(1, "cell"), "1 cell");
  EXPECT_EQ(pluralize(2, "cell"), "2 cells");
  EXPECT_EQ(pluralize(21, "cell"), "21 cells");
  EXPECT_EQ(pluralize(~std::uint64_t(0), "voxel"), "18446744073709551615 voxels");
}

TEST(Counted, TakesAPluralThatIsMoreThanAnS) {
  EXPECT_EQ(pluralize(1, "more loss", "more losses"), "1 more loss");
  EXPECT_EQ(pluralize(3, "more loss", "more losses"), "3 more losses");
  EXPECT_EQ(pluralize(1, "source is", "sources are"), "1 source is");
  EXPECT_EQ(pluralize(0, "source is", "sources are"), "0 sources are");
}

}  // namespace
}  // namespace gigabake
