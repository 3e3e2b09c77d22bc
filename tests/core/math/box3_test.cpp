#include "core/math/box3.h"

#include <gtest/gtest.h>
#include <type_traits>

namespace gigabake {
namespace {

using Box = Box3<int>;
static_assert(std::is_trivially_copyable_v<Box> && sizeof(Box) == sizeof(int[6]));
static_assert(sizeof(Box3i64) == sizeof(std::int64_t[6]) && std::is_standard_layout_v<Box3i64>);
static_assert(Box{}.is_empty());
static_assert(Box::cube({-1, 0, 1}, 2) == Box{{-1, 0, 1}, {1, 2, 3}});
static_assert(Box{{-1, 0, 1}, {1, 3, 5}}.size() == Vec3<int>{2, 3, 4});

/// Calls visit for every box with corners in [0, 2]³, also for empty and inverted ones.
template <class Visit>
void for_each_box(const Visit& visit) {
  for (int code = 0; code < 729; ++code) {
    Box box;
    int rest = code;
    for (int axis = 0; axis < 3; ++axis) {
      box.min[axis] = rest % 3;
      box.end[axis] = rest / 3 % 3;
      rest /= 9;
    }
    visit(box);
  }
}

/// Returns bit x + 2y + 4z for every voxel in [0, 2)³ that the box contains.
unsigned voxels_of(const Box& box) {
  unsigned bits = 0;
  for (int n = 0; n < 8; ++n)
    if (box.contains({n & 1, n >> 1 & 1, n >> 2})) bits |= 1u << n;
  return bits;
}

TEST(Box3, IsEmptyIfAndOnlyIfItContainsNoVoxel) {
  for_each_box([](const Box& box) { ASSERT_EQ(box.is_empty(), voxels_of(box) == 0); });
}

TEST(Box3, ContainsAVoxelOfTheIntersectionInBothBoxes) {
  for_each_box([](const Box& a) {
    for_each_box([&](const Box& b) {
      const Box common = intersection(a, b);
      ASSERT_EQ(voxels_of(common), voxels_of(a) & voxels_of(b));
      if (a.is_empty() || b.is_empty()) return;
      ASSERT_EQ(a.overlaps(b), !common.is_empty());
    });
  });
}

TEST(Box3, HasASmallestHull) {
  for_each_box([](const Box& a) {
    for_each_box([&](const Box& b) {
      const Box both = hull(a, b);
      ASSERT_EQ(voxels_of(both) & voxels_of(a), voxels_of(a));
      ASSERT_EQ(voxels_of(both) & voxels_of(b), voxels_of(b));
      if (a.is_empty() || b.is_empty()) {
        ASSERT_EQ(both, a.is_empty() ? b : a);
        return;
      }
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_TRUE(both.min[axis] == a.min[axis] || both.min[axis] == b.min[axis]);
        ASSERT_TRUE(both.end[axis] == a.end[axis] || both.end[axis] == b.end[axis]);
      }
    });
  });
}

}  // namespace
}  // namespace gigabake
