#include "kernels/body/mip/directional_coverage.h"

#include <gtest/gtest.h>

namespace gigabake::kernels {
namespace {

/// Returns a + b - ab/255, rounded to nearest.
int either_of(int a, int b) { return a + b - (2 * a * b + 255) / 510; }

TEST(DirectionalCoverage, CoversWhatEitherOfTwoCellsCoversForEveryPair) {
  for (std::uint32_t a = 0; a < 256; ++a)
    for (std::uint32_t b = 0; b < 256; ++b) {
      const std::uint32_t cells = a | b << 8 | (255 - a) << 16 | a << 24, others = b | b << 8 | a << 16 | 255u << 24;
      const std::uint32_t either = cover_4(cells, others);
      ASSERT_EQ(int(either & 255), either_of(int(a), int(b))) << a << " and " << b;
      ASSERT_EQ(int(either >> 8 & 255), either_of(int(b), int(b))) << b << " and " << b;
      ASSERT_EQ(int(either >> 16 & 255), either_of(255 - int(a), int(a))) << 255 - a << " and " << a;
      ASSERT_EQ(int(either >> 24), 255) << a << " and 255";
      ASSERT_EQ(sum_4(cells), a + b + 255) << "sum of four cells, " << a << " and " << b;
      std::uint32_t sums[3] = {};
      ASSERT_EQ(cover(CellRun<1>{{cells}}, CellRun<1>{{others}}, sums).word[0], either) << a << " and " << b;
      ASSERT_EQ(sums[0], sum_4(cells));
      ASSERT_EQ(sums[1], sum_4(others));
      ASSERT_EQ(sums[2], sum_4(either));
    }
}

}  // namespace
}  // namespace gigabake::kernels
