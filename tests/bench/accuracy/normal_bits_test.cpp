#include "bench/accuracy/normal_bits.h"

#include <cmath>
#include <gtest/gtest.h>

#include "lattice/octahedral.h"

namespace gigabake::bench {
namespace {

double chord(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

TEST(RoundedNormal, AlongAnAxisIsItselfWithAnyBits) {
  for (int bits = 4; bits <= 32; bits += 2)
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const double sign : {-1, 1}) {
        std::array<double, 3> n{};
        n[axis] = sign;
        EXPECT_NEAR(chord(rounded_normal(n, bits), n), 0, 1e-12) << bits << " bits, axis " << axis;
      }
}

TEST(RoundedNormal, OfSixteenBitsIsWhatShardsHold) {
  for (int i = -127; i <= 127; i += 3)
    for (int j = -127; j <= 127; j += 3) {
      const std::int8_t oct[2] = {std::int8_t(i), std::int8_t(j)};
      const std::array<float, 3> n = unit_normal(oct);
      EXPECT_NEAR(chord(rounded_normal({n[0], n[1], n[2]}, 16), {n[0], n[1], n[2]}), 0, 1e-6) << i << ' ' << j;
    }
}

TEST(RoundedNormal, IsTwiceAsFarOffWithABitLessAnAxis) {
  double before = 0;
  for (const int bits : {16, 14, 12, 10, 8}) {
    double sum = 0;
    constexpr int directions = 20000;
    for (int i = 0; i < directions; ++i) {
      const double z = (i + 0.5) / directions * 2 - 1, turn = i * 2.399963229728653, flat = std::sqrt(1 - z * z);
      const std::array<double, 3> n{flat * std::cos(turn), flat * std::sin(turn), z};
      sum += chord(rounded_normal(n, bits), n) / directions;
    }
    if (before != 0) {
      EXPECT_NEAR(sum / before, 2, 0.2) << bits;
    }
    before = sum;
  }
}

}  // namespace
}  // namespace gigabake::bench
