#include "core/math/octahedral.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace gigabake::kernels {
namespace {

double length(const double n[3]) { return std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]); }

TEST(Octahedral, IsLessThanOneDegreeOff) {
  const std::uint64_t seed = 2;
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> gauss;
  double worst = 0;
  for (int i = 0; i < 400000; ++i) {
    const double v[3] = {gauss(rng), gauss(rng), gauss(rng)};
    std::int8_t stored[2];
    encode_octahedral(v[0], v[1], v[2], stored);
    double n[3];
    decode_octahedral(stored, n);
    worst = std::max(worst, std::acos(std::min(1.0, (v[0] * n[0] + v[1] * n[1] + v[2] * n[2]) / length(v))));
  }
  EXPECT_LE(worst * 180 / std::numbers::pi, 0.96) << "seed " << seed;
}

TEST(Octahedral, DecodesEveryPairOfBytesToUnitLengthAndBack) {
  for (int a = -127; a <= 127; ++a)
    for (int b = -127; b <= 127; ++b) {
      const std::int8_t stored[2] = {std::int8_t(a), std::int8_t(b)};
      double n[3], m[3];
      decode_octahedral(stored, n);
      ASSERT_NEAR(length(n), 1, 1e-12);
      std::int8_t again[2];
      encode_octahedral(n[0], n[1], n[2], again);
      decode_octahedral(again, m);  // on the square's rim two pairs of bytes encode one direction
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(n[c], m[c], 1e-12) << a << ' ' << b;
    }
}

TEST(Octahedral, StoresTheZeroVectorAsUp) {
  std::int8_t stored[2] = {1, 1};
  encode_octahedral(0, 0, 0, stored);
  double n[3];
  decode_octahedral(stored, n);
  EXPECT_EQ(n[2], 1);
}

TEST(Octahedral, DependsOnTheDirectionAlone) {
  std::int8_t a[2], b[2];
  encode_octahedral(1, -2, -3, a);
  encode_octahedral(1024, -2048, -3072, b);
  EXPECT_TRUE(a[0] == b[0] && a[1] == b[1]);
}

}  // namespace
}  // namespace gigabake::kernels
