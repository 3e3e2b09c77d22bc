#include "kernels/body/tables.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace gigabake::kernels {
namespace {

const Tables tables = TableStore::host().view();

/// Returns the sRGB value by IEC 61966-2-1.
double srgb_of(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

TEST(Tables, TakeEverySrgbCodeToLinearAndBack) {
  for (int code = 0; code < 256; ++code) EXPECT_EQ(tables.srgb_from_linear[tables.linear_from_srgb[code]], code);
  EXPECT_EQ(tables.linear_from_srgb[255], 65535);
}

TEST(Tables, GiveTheNearestSrgbCodeOfEveryLinearValue) {
  for (int l = 0; l < 65536; ++l)
    ASSERT_LE(std::abs(tables.srgb_from_linear[l] - 255 * srgb_of(l / 65535.0)), 0.5001) << l;
}

TEST(Tables, HaveUnitNormals) {
  for (int i = 0; i < 65536; ++i) {
    const std::int16_t* n = tables.unit_normal + 4 * i;
    ASSERT_NEAR(std::sqrt(double(n[0]) * n[0] + double(n[1]) * n[1] + double(n[2]) * n[2]), 32767, 1) << i;
  }
}

TEST(Tables, RaiseMeanAlphaToOneMinusItself) {
  EXPECT_EQ(tables.thesis_alpha[0], 0);
  EXPECT_EQ(tables.thesis_alpha[64 * 255], 255);
  for (int sum = 1; sum < 64 * 255; ++sum) {
    const double a = sum / 16320.0;
    ASSERT_LE(std::abs(tables.thesis_alpha[sum] - 255 * std::pow(a, 1 - a)), 0.5001) << sum;
  }
}

// A surface passes through 127/n voxels of a column on average, where n/127 is its normal's component along the column.
TEST(Tables, HaveOfASheetsVoxelsThatTogetherTheyCoverWhatItDoes) {
  for (int alpha = 0; alpha < 256; ++alpha)
    for (int n = 1; n < int(normal_steps); ++n) {
      const double one = tables.planar_coverage[alpha * int(normal_steps) + n] / 255.0, voxels = 127.0 / n;
      const double low = std::max(one - 0.501 / 255, 0.0), high = std::min(one + 0.501 / 255, 1.0);
      ASSERT_LE(1 - std::pow(1 - low, voxels), alpha / 255.0 + 1e-9) << alpha << " " << n;
      ASSERT_GE(1 - std::pow(1 - high, voxels), alpha / 255.0 - 1e-9) << alpha << " " << n;
    }
  for (int n = 1; n < int(normal_steps); ++n) EXPECT_EQ(tables.planar_coverage[255 * int(normal_steps) + n], 255) << n;
}

}  // namespace
}  // namespace gigabake::kernels
