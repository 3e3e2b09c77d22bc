#include "bench/accuracy/flip.h"

#include <gtest/gtest.h>

#include "tests/bench/accuracy/made_picture.h"

namespace gigabake::bench {
namespace {

double flip_of(const LinearPicture& a, const LinearPicture& b) {
  return flip(over(a, 0), over(b, 0), a.width, a.height);
}

TEST(Flip, EqualPicturesDoNotDiffer) {
  const LinearPicture picture = noise(40, 30, 1);
  EXPECT_EQ(flip_of(picture, picture), 0);
}

TEST(Flip, StaysBetweenZeroAndOneAndIsSymmetric) {
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    const LinearPicture a = noise(24, 17, 2 * seed), b = noise(24, 17, 2 * seed + 1);
    EXPECT_GT(flip_of(a, b), 0) << seed;
    EXPECT_LE(flip_of(a, b), 1) << seed;
    EXPECT_NEAR(flip_of(a, b), flip_of(b, a), 1e-12) << seed;
  }
}

// The paper maps HyAB 100 between black and white to 0.95 + 0.05 (100^0.7 - 0.4 c) / (0.6 c), with c = 203.3^0.7
// between green and blue: 0.967.
TEST(Flip, BlackAgainstWhiteIsNearlyOne) {
  EXPECT_NEAR(flip_of(plain(16, 16, 0, 0, 0, 1), plain(16, 16, 1, 1, 1, 1)), 0.967, 0.002);
}

TEST(Flip, GreenAgainstBlueIsOne) {
  EXPECT_NEAR(flip_of(plain(16, 16, 0, 1, 0, 1), plain(16, 16, 0, 0, 1, 1)), 1, 1e-3);
}

TEST(Flip, GrowsWithTheDifference) {
  const LinearPicture grey = plain(16, 16, 0.2f, 0.2f, 0.2f, 1);
  double last = 0;
  for (const float v : {0.21f, 0.25f, 0.35f, 0.6f, 1.0f}) {
    const double now = flip_of(grey, plain(16, 16, v, v, v, 1));
    EXPECT_GT(now, last) << v;
    last = now;
  }
}

TEST(Flip, AFineCheckerboardLooksLikeItsMean) {
  LinearPicture board = plain(64, 64, 0.4f, 0.4f, 0.4f, 1), shifted = board;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c) {
        board.rgba[std::size_t(4 * (64 * y + x) + c)] += (x + y) % 2 ? 0.1f : -0.1f;
        shifted.rgba[std::size_t(4 * (64 * y + x) + c)] += (x + y) % 2 ? -0.1f : 0.1f;
      }
  const double fine = flip_of(board, shifted);
  const double coarse = flip_of(plain(64, 64, 0.3f, 0.3f, 0.3f, 1), plain(64, 64, 0.5f, 0.5f, 0.5f, 1));
  EXPECT_LT(fine, coarse / 2);
}

TEST(Flip, AnEdgeCountsForMoreThanAWash) {
  LinearPicture edge = plain(64, 64, 0.2f, 0.2f, 0.2f, 1);
  for (int y = 0; y < 64; ++y)
    for (int x = 32; x < 64; ++x)
      for (int c = 0; c < 3; ++c) edge.rgba[std::size_t(4 * (64 * y + x) + c)] = 0.3f;
  const LinearPicture flat = plain(64, 64, 0.2f, 0.2f, 0.2f, 1), all = plain(64, 64, 0.3f, 0.3f, 0.3f, 1);
  EXPECT_GT(flip_of(flat, edge), flip_of(flat, all) / 2);
}

}  // namespace
}  // namespace gigabake::bench
