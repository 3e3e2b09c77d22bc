#include "viewer/stream/pool_allocator.h"

#include <gtest/gtest.h>
#include <limits>

namespace gigabake {
namespace {

constexpr std::uint32_t all_evictable = std::numeric_limits<std::uint32_t>::max();
constexpr ChildMasks eight_children{255, 0};

TEST(PoolAllocator, KeepsTheNodesOfBricksThatItAllocatedInTheSameRound) {
  const kernels::PoolSizes sizes{2, 16, 16 * kernels::max_parts};
  const ThreadPool pool(1);
  const auto caster = kernels::make_cpu_caster({}, sizes, {}, pool);
  PoolAllocator allocator(2, 4, sizes);
  allocator.begin_round(caster->pass(), all_evictable, false);
  ASSERT_TRUE(allocator.put_children(0, eight_children, *caster));
  constexpr std::uint32_t child = 8;

  allocator.begin_round(caster->pass(), all_evictable, false);
  ASSERT_TRUE(allocator.put_brick(child, 10, *caster));
  EXPECT_FALSE(allocator.put_children(1, eight_children, *caster));
  EXPECT_TRUE(allocator.is_in_use(child));
  EXPECT_TRUE(kernels::is_resident(allocator.node(child).brick));

  allocator.begin_round(caster->pass(), all_evictable, false);
  EXPECT_TRUE(allocator.put_children(1, eight_children, *caster));
  EXPECT_FALSE(kernels::is_resident(allocator.node(0).children));
}

/// An answer that was prepared before the node got another place would show voxels of the previous place.
TEST(PoolAllocator, TellsNodesThatHaveGotAnotherPlaceSinceARound) {
  const kernels::PoolSizes sizes{2, 16, 16 * kernels::max_parts};
  const ThreadPool pool(1);
  const auto caster = kernels::make_cpu_caster({}, sizes, {}, pool);
  PoolAllocator allocator(2, 4, sizes);
  constexpr std::uint32_t child = 8;
  EXPECT_TRUE(allocator.is_settled(1, 0)) << "a root";
  EXPECT_FALSE(allocator.is_settled(child, 0)) << "not in use";

  allocator.begin_round(caster->pass(), all_evictable, false);
  const std::uint32_t first = allocator.round();
  ASSERT_TRUE(allocator.put_children(0, eight_children, *caster));
  EXPECT_TRUE(allocator.is_settled(child, first));
  EXPECT_FALSE(allocator.is_settled(child, first - 1));

  allocator.begin_round(caster->pass(), all_evictable, false);
  ASSERT_TRUE(allocator.put_children(1, eight_children, *caster));
  ASSERT_EQ(allocator.place_of(child).cell, 1u);
  for (int later = 0; later < 2; ++later) {
    EXPECT_FALSE(allocator.is_settled(child, first));
    EXPECT_TRUE(allocator.is_settled(child, first + 1));
    allocator.begin_round(caster->pass(), all_evictable, false);
  }
}

}  // namespace
}  // namespace gigabake
