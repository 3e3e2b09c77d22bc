#include "core/math/vec3.h"

#include <array>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <type_traits>

namespace gigabake {
namespace {

template <class T>
constexpr bool has_layout_of_array =
    sizeof(Vec3<T>) == sizeof(T[3]) &&
    alignof(Vec3<T>) == alignof(T[3]) && std::is_trivial_v<Vec3<T>>&& std::is_standard_layout_v<Vec3<T>>;
static_assert(has_layout_of_array<std::int8_t> && has_layout_of_array<std::uint16_t> && has_layout_of_array<float> &&
              has_layout_of_array<double> && has_layout_of_array<std::int64_t>);

static_assert(Vec3<int>{1, 2, 3} + Vec3<int>{10, 20, 30} == Vec3<int>{11, 22, 33});
static_assert(Vec3<int>{10, 20, 30} - Vec3<int>{1, 2, 3} == Vec3<int>{9, 18, 27});
static_assert(Vec3<int>{-1, 8, -9} >> 3 == Vec3<int>{-1, 1, -2});
static_assert(Vec3<int>{-1, 8, 0} << 3 == Vec3<int>{-8, 64, 0});
static_assert(Vec3<int>{1, -2, 3} * 2 == Vec3<int>{2, -4, 6} && Vec3<int>{2, -4, 6} / 2 == Vec3<int>{1, -2, 3});
static_assert(Vec3<int>{0, 1, 9} < Vec3<int>{1, 0, 0} && Vec3<int>{1, 0, 9} < Vec3<int>{1, 1, 0});
static_assert(cross(Vec3<int>{1, 0, 0}, Vec3<int>{0, 1, 0}) == Vec3<int>{0, 0, 1});
static_assert(min_by_axis(Vec3<int>{1, 5, 3}, Vec3<int>{2, 4, 3}) == Vec3<int>{1, 4, 3});
static_assert(max_by_axis(Vec3<int>{1, 5, 3}, Vec3<int>{2, 4, 3}) == Vec3<int>{2, 5, 3});
static_assert(Vec3<int>{1, 2, 3}.zyx() == Vec3<int>{3, 2, 1});
static_assert(Vec3d::from(std::array<float, 4>{1, -2, 0.5f, 9}) == Vec3d{1, -2, 0.5});
static_assert(Vec3d(Vec3i64{-1, 2, std::int64_t(1) << 52}) == Vec3d{-1, 2, 0x1p52});

TEST(Vec3, CallsEachAxisInOrder) {
  int calls = 0;
  const auto v = Vec3<int>::by_axis([&](int axis) { return 10 * axis + calls++; });
  EXPECT_EQ(v, (Vec3<int>{0, 11, 22}));
}

/// Draws doubles of very different magnitudes, so that another order of additions would round differently.
TEST(Vec3, RoundsLikeTheLoopOverAxes) {
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> mantissa(-1, 1);
  std::uniform_int_distribution<int> exponent(-20, 20);
  int other_orders = 0;
  for (int i = 0; i < 100000; ++i) {
    const auto draw = [&](int) { return std::ldexp(mantissa(rng), exponent(rng)); };
    const Vec3d a = Vec3d::by_axis(draw), b = Vec3d::by_axis(draw);
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) sum += a[axis] * b[axis];
    ASSERT_EQ(std::bit_cast<std::uint64_t>(sum), std::bit_cast<std::uint64_t>(dot(a, b)));
    ASSERT_EQ(length(a), std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]));
    other_orders += a[0] * b[0] + (a[1] * b[1] + a[2] * b[2]) != sum;
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_EQ((a + b)[axis], a[axis] + b[axis]);
      ASSERT_EQ((a - b)[axis], a[axis] - b[axis]);
      ASSERT_EQ((a * b[0])[axis], a[axis] * b[0]);
      ASSERT_EQ((a / b[0])[axis], a[axis] / b[0]);
    }
  }
  EXPECT_GT(other_orders, 1000);
}

TEST(Vec3, KeepsTheFirstOfEqualOrUnorderedComponents) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vec3d a{0.0, nan, 1}, b{-0.0, 2, nan};
  for (const Vec3d& v : {min_by_axis(a, b), max_by_axis(a, b)}) {
    EXPECT_FALSE(std::signbit(v[0]));
    EXPECT_TRUE(std::isnan(v[1]));
    EXPECT_EQ(v[2], 1);
  }
}

}  // namespace
}  // namespace gigabake
