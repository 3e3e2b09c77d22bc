#include "kernels/cpu/voxelize/clip.h"

#include <array>
#include <bit>
#include <gtest/gtest.h>
#include <map>
#include <random>

#include "core/octree/morton.h"
#include "tests/random_seed.h"

namespace gigabake::kernels {
namespace {

using Values = std::array<int, 6 + directional_coverage_bytes>;

/// Returns the voxels of a level by their position.
std::map<Vec3i64, Values> voxels_of(const Level& level) {
  std::map<Vec3i64, Values> out;
  std::size_t voxel = 0;
  for (std::size_t b = 0; b < level.key.size(); ++b) {
    EXPECT_EQ(level.first.at(b), voxel);
    for (std::int64_t i = 0; i < 512; ++i) {
      if ((level.mask[8 * b + std::size_t(i) / 64] >> i % 64 & 1) == 0) continue;
      const Vec3i64 at = static_cast<Vec3i64>(demorton(level.key[b])) * 8 + Vec3i64{i % 8, i / 8 % 8, i / 64};
      Values& values = out[at];
      for (std::size_t c = 0; c < 4; ++c) values[c] = level.rgba.at(4 * voxel + c);
      for (std::size_t c = 0; c < 2; ++c) values[4 + c] = level.normal.empty() ? 0 : level.normal.at(2 * voxel + c);
      for (std::size_t c = 0; c < directional_coverage_bytes; ++c)
        values[6 + c] = level.directional_coverage.empty()
                            ? 0
                            : level.directional_coverage.at(directional_coverage_bytes * voxel + c);
      ++voxel;
    }
  }
  EXPECT_EQ(level.first.empty() ? 0 : level.first.back(), voxel);
  EXPECT_EQ(level.rgba.size(), 4 * voxel);
  return out;
}

Level random_level(std::mt19937_64& random, bool has_normals) {
  Level level;
  std::uint64_t voxels = 0;
  for (std::uint64_t key = 0; key < 64; ++key) {
    if (random() % 3 == 0) continue;
    level.key.push_back(key);
    level.first.push_back(voxels);
    for (int w = 0; w < 8; ++w) {
      level.mask.push_back(random() & random() & random());
      voxels += std::uint64_t(std::popcount(level.mask.back()));
    }
  }
  level.first.push_back(voxels);
  for (std::uint64_t i = 0; i < 4 * voxels; ++i) level.rgba.push_back(std::uint8_t(random()));
  for (std::uint64_t i = 0; i < (has_normals ? 2 * voxels : 0); ++i) level.normal.push_back(std::int8_t(random()));
  for (std::uint64_t i = 0; i < (has_normals ? directional_coverage_bytes * voxels : 0); ++i)
    level.directional_coverage.push_back(std::uint8_t(random()));
  return level;
}

TEST(Clip, KeepsExactlyTheVoxelsInsideWithTheirValues) {
  const test::RandomSeed seed;
  std::mt19937_64 random(seed);
  const ThreadPool pool(3);
  for (const bool has_normals : {true, false}) {
    CellParameters parameters;
    parameters.window_min = {-16, 8, 1024};
    const auto is_inside = [](const Vec3i64& v) { return v[0] + 2 * v[1] < 41 && v[2] >= 1029; };
    parameters.kept = [&](const Vec3i64& min, int) {
      VoxelMask mask{};
      for (std::int64_t i = 0; i < 512; ++i)
        if (is_inside(min + Vec3i64{i % 8, i / 8 % 8, i / 64})) mask[std::size_t(i) / 64] |= std::uint64_t(1) << i % 64;
      return mask;
    };
    Level level = random_level(random, has_normals);
    std::map<Vec3i64, Values> expected = voxels_of(level);
    const std::size_t before = expected.size();
    std::erase_if(expected, [&](const auto& voxel) { return !is_inside(parameters.window_min + voxel.first); });
    ASSERT_GT(expected.size(), 0u);
    ASSERT_LT(expected.size(), before);
    clip(level, 0, parameters, pool);
    EXPECT_EQ(voxels_of(level), expected);
    for (std::size_t b = 0; b + 1 < level.first.size(); ++b) EXPECT_LT(level.first[b], level.first[b + 1]);
    EXPECT_EQ(level.normal.empty(), !has_normals);
    EXPECT_EQ(level.directional_coverage.empty(), !has_normals);
  }
}

TEST(Clip, LeavesNothingOfALevelOutside) {
  const test::RandomSeed seed;
  std::mt19937_64 random(seed);
  Level level = random_level(random, true);
  CellParameters parameters;
  parameters.kept = [](const Vec3i64&, int) { return VoxelMask{}; };
  clip(level, 0, parameters, callers_thread());
  EXPECT_TRUE(level.key.empty() && level.mask.empty() && level.rgba.empty() && level.normal.empty());
}

}  // namespace
}  // namespace gigabake::kernels
