/// Assignment of triangles to bricks: no pair is missing, no pair occurs twice, and batches only split the list.
#include "kernels/cpu/voxelize/bin.h"

#include <gtest/gtest.h>
#include <random>
#include <set>

#include "kernels/body/voxelize/triangle_bricks.h"

namespace gigabake::kernels {
namespace {

using Rng = std::mt19937_64;

std::int32_t uniform(Rng& rng, std::int32_t low, std::int32_t high) {
  return std::uniform_int_distribution<std::int32_t>(low, high)(rng);
}

/// Returns triangles of all sizes, some partly outside of the window.
std::vector<WindowTriangle> random_triangles(std::size_t count, std::int32_t window_subvoxels, Rng& rng) {
  std::vector<WindowTriangle> out(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t reach = 1 << uniform(rng, 2, 24), step = uniform(rng, 0, 3) ? 1 : 2048;
    Vec3<std::int32_t> near;
    for (auto& x : near) x = uniform(rng, -2000, window_subvoxels + 2000);
    for (auto& p : out[i].p)
      for (int c = 0; c < 3; ++c) p[c] = (near[c] + uniform(rng, -reach, reach)) / step * step;
    out[i].part = 0;
    out[i].index = std::uint32_t(i);
  }
  return out;
}

bool touches(const WindowTriangle& t, SurfaceRule rule, std::uint64_t key) {
  const auto brick = make_brick_triangle<__int128>(t, Vec3<std::int32_t>(demorton(key)) << 11);
  if (brick.n[2] == 0) return false;
  std::uint64_t slab[8], any = 0;
  touched_voxels(brick, rule, slab);
  for (const std::uint64_t s : slab) any |= s;
  return any != 0;
}

class Bin : public testing::TestWithParam<SurfaceRule> {};

TEST_P(Bin, FindsEveryBrickThatATriangleTouchesOnce) {
  const std::uint64_t seed = 4;
  Rng rng(seed);
  CellParameters parameters;
  parameters.window_voxels = 64;
  parameters.surface = GetParam();
  const CellWindow window = window_of(parameters);
  for (const WindowTriangle& t : random_triangles(2000, 64 * 256, rng)) {
    std::multiset<std::uint64_t> found;
    for_each_brick(t, window, [&](std::uint64_t key) { found.insert(key); });
    for (std::uint64_t key = 0; key < 512; ++key) {
      ASSERT_LE(found.count(key), 1u) << "seed " << seed << " triangle " << t.index;
      if (touches(t, GetParam(), key)) {
        ASSERT_EQ(found.count(key), 1u) << "seed " << seed << " triangle " << t.index;
      }
    }
  }
}

TEST_P(Bin, GivesTheSamePairsInAnyBatches) {
  const std::uint64_t seed = 5;
  Rng rng(seed);
  const ThreadPool pool(2);
  CellParameters parameters;
  parameters.window_voxels = 256;
  parameters.surface = GetParam();
  const auto triangles = random_triangles(2000, 256 * 256, rng);
  const auto pairs_in_batches_of = [&](std::uint64_t maximum) {
    std::vector<Pair> all;
    std::uint64_t end_key = 0;
    CellStats stats;
    for (const Batch& batch : plan_batches(triangles, parameters, maximum, pool)) {
      EXPECT_GE(batch.first_key, end_key);
      end_key = batch.end_key;
      const auto pairs = sorted_pairs(triangles, parameters, batch, pool, stats);
      EXPECT_EQ(pairs.size(), batch.pairs);
      all.insert(all.end(), pairs.begin(), pairs.end());
    }
    EXPECT_EQ(stats.pairs, all.size());
    EXPECT_TRUE(std::is_sorted(all.begin(), all.end(), [](Pair a, Pair b) { return brick_of(a) < brick_of(b); }));
    std::sort(all.begin(), all.end());
    return all;
  };
  const auto whole = pairs_in_batches_of(1u << 30);
  ASSERT_GT(whole.size(), 5000u);
  EXPECT_EQ(pairs_in_batches_of(whole.size() / 3), whole) << "seed " << seed;
  EXPECT_EQ(pairs_in_batches_of(whole.size() / 40), whole) << "seed " << seed;
}

INSTANTIATE_TEST_SUITE_P(Rule, Bin, testing::Values(SurfaceRule::area, SurfaceRule::conservative, SurfaceRule::thin));

}  // namespace
}  // namespace gigabake::kernels
