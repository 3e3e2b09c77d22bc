#include "bench/accuracy/picture_error.h"

#include <cmath>
#include <gtest/gtest.h>

#include "tests/bench/accuracy/made_picture.h"

namespace gigabake::bench {
namespace {

/// Returns the image with a transparent left half.
LinearPicture right_half(LinearPicture picture) {
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width / 2; ++x)
      for (int c = 0; c < 4; ++c) picture.rgba[std::size_t(4 * (picture.width * y + x) + c)] = 0;
  return picture;
}

TEST(PictureError, IsNoneBetweenEqualPictures) {
  const LinearPicture picture = noise(20, 20, 3);
  const PictureError e = picture_error(picture, picture);
  EXPECT_EQ(e.psnr_black_db, 100);
  EXPECT_EQ(e.psnr_white_db, 100);
  EXPECT_EQ(e.silhouette_iou, 1);
  for (const double zero : {e.coverage_bias, e.rms_colour, e.delta_e, e.flip}) EXPECT_EQ(zero, 0);
}

TEST(PictureError, APlainDifferenceHasItsClosedForm) {
  const double a = 0.2, b = 0.3;
  const PictureError e =
      picture_error(plain(16, 16, float(a), float(a), float(a), 1), plain(16, 16, float(b), float(b), float(b), 1));
  EXPECT_NEAR(e.rms_colour, b - a, 1e-6);
  EXPECT_NEAR(e.psnr_black_db, -20 * std::log10(srgb_code(b) - srgb_code(a)), 1e-4);
  EXPECT_NEAR(e.psnr_white_db, e.psnr_black_db, 1e-9) << "the background is hidden";
  EXPECT_NEAR(e.delta_e, 116 * (std::cbrt(b) - std::cbrt(a)), 1e-3) << "greys differ only in lightness";
  EXPECT_EQ(e.holes, 0);
}

TEST(PictureError, WhatIsMissingIsAHoleAndNoColour) {
  const LinearPicture whole = plain(16, 16, 0.5f, 0.4f, 0.1f, 1), half = right_half(whole);
  const PictureError missing = picture_error(whole, half), added = picture_error(half, whole);
  EXPECT_NEAR(missing.holes, 0.5, 1e-6);
  EXPECT_NEAR(missing.coverage_bias, -0.5, 1e-6);
  EXPECT_NEAR(missing.silhouette_iou, 0.5, 1e-6);
  EXPECT_EQ(missing.rms_colour, 0);
  EXPECT_EQ(missing.delta_e, 0);
  EXPECT_EQ(added.holes, 0);
  EXPECT_NEAR(added.coverage_bias, 0.5, 1e-6);
}

TEST(PictureError, ABackgroundShowsThroughWhatIsTooThin) {
  const PictureError e = picture_error(plain(16, 16, 0, 0, 0, 1), plain(16, 16, 0, 0, 0, 0.9f));
  EXPECT_EQ(e.psnr_black_db, 100);
  EXPECT_LT(e.psnr_white_db, 15);
  EXPECT_GT(e.flip, 0.1) << "the worse of the two backgrounds";
  EXPECT_NEAR(e.holes, 0.1, 1e-6);
}

TEST(PictureError, EmptyPicturesAgree) {
  const LinearPicture nothing = plain(9, 9, 0, 0, 0, 0);
  const PictureError e = picture_error(nothing, nothing);
  EXPECT_EQ(e.psnr_white_db, 100);
  EXPECT_EQ(e.silhouette_iou, 1);
  EXPECT_EQ(e.flip, 0);
}

TEST(PictureError, AMeanTakesTheBiasByItsMagnitude) {
  PictureError a, b;
  a.coverage_bias = -0.1, b.coverage_bias = 0.3;
  a.holes = 0.1, b.holes = 0.2;
  const PictureError mean = mean_error({a, b});
  EXPECT_NEAR(mean.coverage_bias, 0.2, 1e-12);
  EXPECT_NEAR(mean.holes, 0.15, 1e-12);
}

TEST(LinearPicture, IsWithinHalfACodeOfItsBytes) {
  const LinearPicture picture = noise(30, 30, 7);
  const LinearPicture again = to_linear(to_srgb(picture));
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) EXPECT_NEAR(picture.rgba[i], again.rgba[i], 0.008) << i;
}

}  // namespace
}  // namespace gigabake::bench
