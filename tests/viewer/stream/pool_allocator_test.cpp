#include "viewer/stream/pool_allocator.h"

#include <gtest/gtest.h>
#include <limits>
#include <vector>

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

/// A large pool whose slots all hold a brick of two parts. Its bricks were allocated in passes 1, 2, …, of
/// `bricks_per_pass` bricks each.
class FullPool {
 public:
  static constexpr std::uint32_t slots = 1 << 17, parts = 2, voxels = slots * parts, roots = 30000,
                                 bricks_per_pass = 4096;

  FullPool() {
    for (std::uint32_t root = 0; root < roots; ++root) {
      allocator.begin_round(1, 1, false);
      EXPECT_TRUE(allocator.put_children(root, eight_children, *caster));
    }
    for (std::uint32_t pass = 1; bricks.size() < slots; ++pass) {
      allocator.begin_round(pass, pass, false);
      for (std::uint32_t i = 0; i < bricks_per_pass; ++i) put();
    }
  }

  /// Allocates a brick for the next node without one. Returns its slot.
  std::uint32_t put() {
    const std::optional<std::uint32_t> slot = allocator.put_brick(next_node_++, parts, *caster);
    EXPECT_TRUE(slot);
    bricks.push_back({next_node_ - 1, slot.value_or(0)});
    return slot.value_or(0);
  }
  /// Returns the indices of the bricks that were evicted.
  std::vector<std::uint32_t> evicted() const {
    std::vector<std::uint32_t> out;
    for (std::uint32_t i = 0; i < bricks.size(); ++i)
      if (allocator.node(bricks[i].node).brick != bricks[i].slot) out.push_back(i);
    return out;
  }
  void expect_apart() const {
    std::vector<bool> is_taken(voxels);
    for (const Brick& brick : bricks) {
      if (allocator.node(brick.node).brick != brick.slot) continue;
      const kernels::BrickPlace place = allocator.brick_place(brick.slot);
      ASSERT_EQ(place.first / (voxels / 2), brick.slot / (slots / 2)) << "a brick left its segment";
      for (std::uint32_t v = place.first; v < place.first + parts; ++v) {
        ASSERT_FALSE(is_taken.at(v)) << "two bricks share voxel " << v;
        is_taken[v] = true;
      }
    }
  }

  struct Brick {
    std::uint32_t node = 0, slot = 0;
  };
  kernels::PoolSizes sizes{roots / 8 + roots, slots, voxels};
  ThreadPool pool{1};
  std::unique_ptr<kernels::Caster> caster = kernels::make_cpu_caster({}, sizes, {}, pool);
  PoolAllocator allocator{roots, 4, sizes};
  std::vector<Brick> bricks;

 private:
  std::uint32_t next_node_ = roots;
};

/// 2026-11-30: an eviction in a pool of 4 GB took 0.1 s, because it examined all bricks and moved most of them.
TEST(PoolAllocator, EvictsTheOldestBricksOfOneSegmentAfterAnother) {
  FullPool pool;
  EXPECT_FALSE(pool.allocator.has_room(1));
  EXPECT_EQ(pool.allocator.in_use().slots, FullPool::slots);
  EXPECT_EQ(pool.allocator.in_use().voxels, FullPool::voxels);
  constexpr std::uint32_t segment = FullPool::slots / 2, at_once = 1 + segment / 4;
  pool.allocator.begin_round(100, 100, false);
  EXPECT_LT(pool.put(), segment);
  ASSERT_EQ(pool.evicted().size(), at_once);
  EXPECT_LT(pool.evicted().back(), (at_once / FullPool::bricks_per_pass + 1) * FullPool::bricks_per_pass)
      << "of the first segment, the bricks of the first passes are the oldest";
  pool.expect_apart();

  for (std::uint32_t i = 1; i < at_once; ++i) pool.put();
  EXPECT_EQ(pool.evicted().size(), at_once);
  EXPECT_GE(pool.put(), segment) << "the first segment is full again";
  EXPECT_EQ(pool.evicted().size(), 2 * at_once);
  pool.expect_apart();
}

TEST(PoolAllocator, EvictsUsedBricksOnlyIfAllSegmentsAreInUse) {
  FullPool pool;
  constexpr std::uint32_t first_pass_of_second_segment = FullPool::slots / 2 / FullPool::bricks_per_pass + 1;
  pool.allocator.begin_round(100, first_pass_of_second_segment, true);
  for (std::uint32_t i = 0; i < FullPool::slots / 2; ++i) ASSERT_LT(pool.put(), FullPool::slots / 2);
  EXPECT_FALSE(pool.allocator.evicted_used());
  EXPECT_EQ(pool.allocator.in_use().slots, FullPool::slots);

  pool.allocator.begin_round(101, first_pass_of_second_segment, false);
  EXPECT_FALSE(pool.allocator.put_brick(FullPool::roots, FullPool::parts, *pool.caster)) << "all are in use";
  pool.allocator.begin_round(102, first_pass_of_second_segment, true);
  EXPECT_TRUE(pool.allocator.put_brick(FullPool::roots, FullPool::parts, *pool.caster));
  EXPECT_TRUE(pool.allocator.evicted_used());
}

TEST(PoolAllocator, EvictsTilesOfALargePoolInTurn) {
  constexpr std::uint32_t roots = 150000, tiles = roots / 8 + (1 << 17), examined = tiles / 2,
                          at_once = 1 + examined / 4;
  const kernels::PoolSizes sizes{tiles, 1 << 19, 16 * kernels::max_parts};
  const ThreadPool pool(1);
  const auto caster = kernels::make_cpu_caster({}, sizes, {}, pool);
  PoolAllocator allocator(roots, 4, sizes);
  std::uint32_t root = 0;
  const auto put = [&] { return allocator.put_children(root++, eight_children, *caster); };
  allocator.begin_round(1, 1, false);
  while (allocator.in_use().tiles < tiles) ASSERT_TRUE(put());
  EXPECT_FALSE(put()) << "all were allocated in this round";

  for (std::uint32_t turn = 1; turn <= 2; ++turn) {
    allocator.begin_round(turn + 1, turn + 1, false);
    ASSERT_TRUE(put());
    EXPECT_EQ(allocator.in_use().tiles, tiles - at_once + 1);
    while (allocator.in_use().tiles < tiles) ASSERT_TRUE(put());
  }
}

}  // namespace
}  // namespace gigabake
