#include "viewer/stream/voxel_arena.h"

#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace gigabake {
namespace {

constexpr std::uint32_t slots = 40, voxels = 1000;

/// The voxels of the pool, moved as a caster moves them, and the expected content of each slot.
class Pool {
 public:
  void put(std::uint32_t slot, std::uint32_t count, std::uint32_t content) {
    arena.take(slot, count);
    held_[slot] = {count, content};
    for (std::uint32_t i = 0; i < count; ++i) voxel_[arena.first(slot) + i] = content;
  }
  void give_back(std::uint32_t slot) {
    arena.give_back(slot);
    held_[slot] = {};
  }
  void close_gaps() {
    std::uint32_t end = 0;
    for (const kernels::VoxelMove& move : arena.close_gaps()) {
      ASSERT_LT(move.to, move.from);
      if (end != 0) {
        ASSERT_EQ(move.to, end) << "no gap is left";
      }
      end = move.to + move.count;
      for (std::uint32_t i = 0; i < move.count; ++i) voxel_[move.to + i] = voxel_[move.from + i];
    }
  }
  std::uint32_t held(std::uint32_t slot) const { return held_[slot].count; }
  void expect_all_there() const {
    std::uint32_t sum = 0;
    for (std::uint32_t slot = 0; slot < slots; ++slot) {
      sum += held_[slot].count;
      for (std::uint32_t i = 0; i < held_[slot].count; ++i)
        ASSERT_EQ(voxel_[arena.first(slot) + i], held_[slot].content) << "slot " << slot << ", voxel " << i;
    }
    ASSERT_EQ(arena.free(), voxels - sum);
  }

  VoxelArena arena{slots, voxels};

 private:
  struct Held {
    std::uint32_t count = 0, content = 0;
  };
  std::vector<Held> held_{slots};
  std::vector<std::uint32_t> voxel_ = std::vector<std::uint32_t>(voxels);
};

TEST(VoxelArena, KeepsWhatStandsInItWhereverItMoves) {
  constexpr std::uint64_t seed = 20261123;
  std::mt19937_64 random(seed);
  Pool pool;
  std::size_t closed = 0;
  for (std::uint32_t step = 1; step < 5000; ++step) {
    const auto slot = std::uint32_t(random() % slots);
    const auto count = std::uint32_t(1 + random() % 90);
    if (pool.held(slot) != 0) {
      pool.give_back(slot);
    } else if (pool.arena.free() >= count) {
      if (!pool.arena.has_room(count)) {
        pool.close_gaps();
        ++closed;
      }
      ASSERT_TRUE(pool.arena.has_room(count)) << "all that is free is at the end";
      pool.put(slot, count, step);
    }
    if (step % 50 == 0) pool.expect_all_there();
    if (::testing::Test::HasFatalFailure()) FAIL() << "seed " << seed << ", step " << step;
  }
  EXPECT_GT(closed, 10u);
}

}  // namespace
}  // namespace gigabake
