#include "kernels/cpu/prune/prune.h"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <map>

#include "format/shard/levels/brick_walk.h"
#include "tests/kernels/made_tree.h"
#include "tests/random_seed.h"

namespace gigabake::kernels {
namespace {

using Place = std::array<std::uint32_t, 3>;
using Content = std::array<std::uint8_t, 4 + 2 + directional_coverage_bytes>;
using Voxels = std::map<Place, Content>;

/// Returns a function that adds a voxel to `voxels`, and fails the test if the voxel is already there.
auto taker(Voxels& voxels) {
  return [&voxels](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba,
                   const std::int8_t* normal, const std::uint8_t* directional_coverage) {
    Content content{};
    std::copy_n(rgba, 4, content.begin());
    std::copy_n(normal, 2, content.begin() + 4);
    if (directional_coverage != nullptr)
      std::copy_n(directional_coverage, directional_coverage_bytes, content.begin() + 6);
    EXPECT_TRUE(voxels.emplace(Place{x, y, z}, content).second) << "twice: " << x << ' ' << y << ' ' << z;
  };
}

/// Returns all voxels of the level. Their positions come from the keys of the bricks, not from nodes.
Voxels all_voxels(const Level& level) {
  Voxels voxels;
  for (std::size_t b = 0; b < level.key.size(); ++b) for_each_voxel(level, b, demorton(level.key[b]), taker(voxels));
  return voxels;
}

Voxels expanded(const NodeTable& nodes, const Level& level, int lod, bool directional_coverage) {
  Voxels voxels;
  const auto take = taker(voxels);
  for_each_voxel_of_level(
      nodes, level, lod,
      [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba, const std::int8_t* normal,
          const std::uint8_t* of_axes) { take(x, y, z, rgba, normal, directional_coverage ? of_axes : nullptr); });
  return voxels;
}

bool is_of_one_value(const Level& level, std::size_t brick) {
  Voxels voxels;
  for_each_voxel(level, brick, {0, 0, 0}, taker(voxels));
  return voxels.size() == std::size_t(brick_voxels) &&
         std::ranges::all_of(voxels, [&](const auto& voxel) { return voxel.second == voxels.begin()->second; });
}

TEST(Prune, LosesNothingAndLeavesNoBrickOfOneValue) {
  const gigabake::test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  std::map<NodeKind, std::size_t> nodes_of;
  for (int round = 0; round < 12; ++round) {
    const bool directional_coverage = round % 2 == 0;
    const std::vector<Level> levels = test::MadeTree(rng, 1 + rng() % 3, rng() % 3 != 0, directional_coverage).levels();
    std::vector<Level> pruned = levels;
    const NodeTable nodes = prune(pruned, ThreadPool(2));
    for (const NodeKind kind : nodes.kind) ++nodes_of[kind];
    for (std::size_t lod = 0; lod < levels.size(); ++lod) {
      EXPECT_TRUE(expanded(nodes, pruned[lod], int(lod), directional_coverage) == all_voxels(levels[lod]))
          << "lod " << lod;
      for (std::size_t b = 0; b < pruned[lod].key.size(); ++b) EXPECT_FALSE(is_of_one_value(pruned[lod], b));
    }
  }
  for (const NodeKind kind : {NodeKind::brick, NodeKind::constant, NodeKind::leaf_constant})
    EXPECT_GT(nodes_of[kind], 5u) << int(kind);
}

}  // namespace
}  // namespace gigabake::kernels
