// Wholes by additions are what the language's conversions say, over all of their range.
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "kernels/cast/scene.h"

namespace gigabake::kernels {
namespace {

constexpr std::uint64_t seed = 20261124;
constexpr std::int64_t beyond = std::int64_t(1) << 51;  // none of the range lies there, nor at its negative

void expect_right(double value) {
  ASSERT_EQ(floor_of(value), std::floor(value)) << value;
  ASSERT_EQ(ceil_of(value), std::ceil(value)) << value;
  ASSERT_EQ(to_whole(floor_of(value)), std::int64_t(std::floor(value))) << value;
}

TEST(WholeNumbers, AreRightBesideEachWhole) {
  for (std::int64_t magnitude = 1; magnitude < beyond; magnitude *= 2)
    for (std::int64_t whole = magnitude - 2; whole <= magnitude + 2; ++whole)
      for (const double value : {double(whole), -double(whole)})
        for (const double towards : {-1e300, 1e300}) {
          expect_right(value);
          expect_right(std::nextafter(value, towards));
          expect_right(value + 0.5);
        }
}

TEST(WholeNumbers, AreRightAnywhere) {
  std::mt19937_64 random(seed);
  for (int i = 0; i < 200000; ++i) {
    const std::int64_t whole = std::int64_t(random() % (2 * std::uint64_t(beyond) - 1)) - beyond + 1 >> random() % 51;
    ASSERT_EQ(to_double(whole), double(whole)) << whole << ", seed " << seed;
    ASSERT_EQ(to_whole(double(whole)), whole) << whole << ", seed " << seed;
    expect_right(std::ldexp(double(whole), -int(random() % 60)));
  }
}

}  // namespace
}  // namespace gigabake::kernels
