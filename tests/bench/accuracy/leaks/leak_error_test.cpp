#include "bench/accuracy/leaks/leak_error.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "tests/bench/accuracy/made_picture.h"

namespace gigabake::bench {
namespace {

constexpr int edge = 20;

std::size_t at(int x, int y) { return std::size_t(y * edge + x); }

/// Returns an image that is transparent except for a square in the middle: pixels 4 to 15 along both axes.
AlphaPicture square_of(double alpha) {
  AlphaPicture picture{edge, edge, std::vector<double>(std::size_t(edge * edge), 0)};
  for (int y = 4; y < 16; ++y)
    for (int x = 4; x < 16; ++x) picture.alpha[at(x, y)] = alpha;
  return picture;
}

/// Returns a black image with the given alpha.
LinearPicture picture_of(const AlphaPicture& alpha) {
  LinearPicture picture{alpha.width, alpha.height, {}};
  for (const double a : alpha.alpha) picture.rgba.insert(picture.rgba.end(), {0, 0, 0, float(a)});
  return picture;
}

TEST(InnerPixels, LieThreePixelsInside) {
  const std::vector<bool> inner = inner_pixels(square_of(1));
  for (int y = 0; y < edge; ++y)
    for (int x = 0; x < edge; ++x) EXPECT_EQ(inner[at(x, y)], x >= 7 && x <= 12 && y >= 7 && y <= 12) << x << " " << y;
}

TEST(InnerPixels, AreNotAtThePicturesBorder) {
  const AlphaPicture whole{edge, edge, std::vector<double>(std::size_t(edge * edge), 1)};
  const std::vector<bool> inner = inner_pixels(whole);
  EXPECT_EQ(std::count(inner.begin(), inner.end(), true), 14 * 14);
  EXPECT_FALSE(inner[at(2, 10)]);
  EXPECT_TRUE(inner[at(3, 10)]);
}

TEST(InnerPixels, DoNotStandWhereTheNumberOfLayersChanges) {
  AlphaPicture inside{edge, edge, std::vector<double>(std::size_t(edge * edge), 0.3)};
  for (int y = 0; y < edge; ++y)
    for (int x = 10; x < edge; ++x) inside.alpha[at(x, y)] = 0.51;
  const std::vector<bool> inner = inner_pixels(inside);
  for (int x = 0; x < edge; ++x) EXPECT_EQ(inner[at(x, 10)], (x >= 3 && x <= 6) || (x >= 13 && x <= 16)) << x;
}

TEST(LeakError, ABorderThatIsTransparentIsNoLeak) {
  const AlphaPicture reference_alpha = square_of(1);
  const LeakError e = leak_error(inner_pixels(reference_alpha), reference_alpha, picture_of(reference_alpha));
  EXPECT_EQ(e.inner, 36u);
  for (const double zero : {e.below_99, e.below_90, e.rms, e.bias}) EXPECT_EQ(zero, 0);
  EXPECT_EQ(e.minimum, 1);
  EXPECT_TRUE(is_bounded(e));
}

TEST(LeakError, OneTransparentPixelInsideIsOne) {
  const AlphaPicture reference_alpha = square_of(1);
  LinearPicture picture = picture_of(reference_alpha);
  picture.rgba[4 * at(9, 8) + 3] = 0;
  const LeakError e = leak_error(inner_pixels(reference_alpha), reference_alpha, picture);
  EXPECT_DOUBLE_EQ(e.below_99, 1.0 / 36);
  EXPECT_DOUBLE_EQ(e.below_90, 1.0 / 36);
  EXPECT_EQ(e.minimum, 0);
  EXPECT_DOUBLE_EQ(e.bias, -1.0 / 36);
  EXPECT_DOUBLE_EQ(e.rms, 1.0 / 6);
  EXPECT_FALSE(is_bounded(e));
}

TEST(LeakError, NearTheBorderNothingCounts) {
  const AlphaPicture reference_alpha = square_of(1);
  LinearPicture picture = picture_of(reference_alpha);
  picture.rgba[4 * at(6, 9) + 3] = 0;
  EXPECT_EQ(leak_error(inner_pixels(reference_alpha), reference_alpha, picture).below_99, 0);
}

TEST(LeakError, TheTwoThresholdsAreThoseOfTheirNames) {
  const AlphaPicture reference_alpha = square_of(1);
  LinearPicture picture = picture_of(reference_alpha);
  picture.rgba[4 * at(8, 8) + 3] = 0.991f;
  picture.rgba[4 * at(9, 8) + 3] = 0.985f;
  picture.rgba[4 * at(10, 8) + 3] = 0.899f;
  const LeakError e = leak_error(inner_pixels(reference_alpha), reference_alpha, picture);
  EXPECT_DOUBLE_EQ(e.below_99, 2.0 / 36);
  EXPECT_DOUBLE_EQ(e.below_90, 1.0 / 36);
  EXPECT_NEAR(e.minimum, 0.899, 1e-6);
}

TEST(LeakError, APaneMayBeTooThinAndTooThick) {
  const AlphaPicture reference_alpha = square_of(0.3);
  const std::vector<bool> inner = inner_pixels(reference_alpha);
  const LeakError thick = leak_error(inner, reference_alpha, picture_of(square_of(0.5)));
  EXPECT_NEAR(thick.bias, 0.2, 1e-6);
  EXPECT_NEAR(thick.rms, 0.2, 1e-6);
  EXPECT_EQ(thick.below_99, 0);
  const LeakError thin = leak_error(inner, reference_alpha, picture_of(square_of(0.1)));
  EXPECT_NEAR(thin.bias, -0.2, 1e-6);
  EXPECT_EQ(thin.below_90, 1);
}

TEST(LeakError, OfTwoPicturesIsThatOfAllTheirPixels) {
  LeakError a, b;
  a.inner = 30, a.below_99 = 0.1, a.minimum = 0.5, a.bias = -0.1, a.rms = 0.2;
  b.inner = 10, b.below_99 = 0.5, b.minimum = 0.8, b.bias = 0.3, b.rms = 0.4;
  const LeakError both = together(a, b);
  EXPECT_EQ(both.inner, 40u);
  EXPECT_DOUBLE_EQ(both.below_99, 0.2);
  EXPECT_EQ(both.minimum, 0.5);
  EXPECT_NEAR(both.bias, 0, 1e-12);
  EXPECT_DOUBLE_EQ(both.rms, std::sqrt((30 * 0.04 + 10 * 0.16) / 40));
  EXPECT_EQ(together(LeakError(), b).below_99, b.below_99);
  EXPECT_EQ(together(a, LeakError()).inner, a.inner);
}

}  // namespace
}  // namespace gigabake::bench
