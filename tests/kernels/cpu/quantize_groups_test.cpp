#include "kernels/cpu/voxelize/quantize_groups.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <tuple>

#include "core/octree/brick.h"
#include "kernels/body/voxelize/quantize_groups.h"
#include "tests/random_seed.h"

namespace gigabake::kernels {
namespace {

/// Returns bricks with smooth or noisy colours. Their normals differ by small or large angles.
Level made_level(std::mt19937_64& rng, std::size_t bricks) {
  Level level;
  level.first = {0};
  for (std::size_t b = 0; b < bricks; ++b) {
    level.key.push_back(b);
    const int noise = 1 + int(rng() % 40), tilt = int(rng() % 60);
    const int base[6] = {int(rng() % 256), int(rng() % 256), int(rng() % 256),
                         int(rng() % 256), int(rng() % 127), int(rng() % 127)};
    std::uint64_t voxels = 0;
    for (int z = 0; z < 8; ++z) {
      level.mask.push_back(z == 0 ? rng() | 1 : rng() & rng());
      voxels += std::uint64_t(std::popcount(level.mask.back()));
    }
    for (std::uint64_t v = 0; v < voxels; ++v) {
      for (int c = 0; c < 4; ++c)
        level.rgba.push_back(std::uint8_t(std::clamp(base[c] + int(rng() % unsigned(noise)), c == 3 ? 1 : 0, 255)));
      for (int c = 4; c < 6; ++c)
        level.normal.push_back(std::int8_t(std::clamp(base[c] - int(rng() % unsigned(1 + tilt)), -127, 127)));
    }
    level.first.push_back(level.first.back() + voxels);
  }
  return level;
}

double half_chord(const std::int8_t* a, const std::int8_t* b) {
  double n[3], m[3];
  decode_octahedral(a, n);
  decode_octahedral(b, m);
  return std::hypot(n[0] - m[0], n[1] - m[1], n[2] - m[2]) / 2;
}

struct Changes {
  std::size_t colours = 0, alphas = 0, normals = 0;
};

/// Expects every colour and normal to be within the error bound for `codes`. Returns the numbers of changed values.
Changes expect_bound(const Level& exact, const Level& off, std::uint32_t codes) {
  Changes changes;
  EXPECT_EQ(exact.mask, off.mask);
  EXPECT_EQ(exact.first, off.first);
  for (std::size_t v = 0; v < exact.first.back(); ++v) {
    for (std::size_t c = 0; c < 4; ++c) {
      const int difference = std::abs(int(exact.rgba[4 * v + c]) - int(off.rgba[4 * v + c]));
      EXPECT_LE(difference, int(codes)) << "voxel " << v << ", channel " << c << "";
      (c < 3 ? changes.colours : changes.alphas) += difference != 0;
    }
    EXPECT_GT(off.rgba[4 * v + 3], 0) << "a voxel vanished";
    const double chord = half_chord(&exact.normal[2 * v], &off.normal[2 * v]);
    EXPECT_LE(chord, codes / 255.0 + 5e-5) << "voxel " << v << "";
    changes.normals += chord != 0;
    if (testing::Test::HasFailure()) return changes;
  }
  return changes;
}

TEST(Approximate, KeepsEveryVoxelWithinTheBound) {
  const gigabake::test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const ThreadPool pool(2);
  Changes all;
  for (const std::uint32_t codes : {1u, 2u, 3u, 4u, 8u, 16u, 40u, 127u}) {
    const Level exact = made_level(rng, 600);
    std::vector<Level> off{exact};
    quantize_groups(off, codes, pool);
    const Changes changes = expect_bound(exact, off[0], codes);
    all.colours += changes.colours, all.alphas += changes.alphas, all.normals += changes.normals;
  }
  EXPECT_GT(all.colours, 1000u);
  EXPECT_GT(all.alphas, 1000u);
  EXPECT_GT(all.normals, 1000u);
}

TEST(Approximate, ChangesNothingWhereNothingMayBeOff) {
  std::mt19937_64 rng(1);
  const Level exact = made_level(rng, 50);
  std::vector<Level> off{exact};
  quantize_groups(off, 0, ThreadPool(1));
  EXPECT_EQ(exact.rgba, off[0].rgba);
  EXPECT_EQ(exact.normal, off[0].normal);
}

TEST(Approximate, IsTheSameForAnyNumberOfThreads) {
  std::mt19937_64 rng(2);
  const Level exact = made_level(rng, 3000);
  std::vector<Level> one{exact}, three{exact};
  quantize_groups(one, 6, ThreadPool(1));
  quantize_groups(three, 6, ThreadPool(3));
  EXPECT_EQ(one[0].rgba, three[0].rgba);
  EXPECT_EQ(one[0].normal, three[0].normal);
}

/// Returns a full brick whose colour increases by one code per voxel along x.
Level ramp() {
  Level level;
  level.key = {0};
  level.mask.assign(8, ~std::uint64_t(0));
  level.first = {0, 512};
  for (int v = 0; v < 512; ++v) {
    level.rgba.insert(level.rgba.end(), {std::uint8_t(100 + v % 8), 50, 50, 255});
    level.normal.insert(level.normal.end(), {0, 0});
  }
  return level;
}

TEST(Approximate, TakesBrickBeforeOctantBeforeGroup) {
  const ThreadPool pool(1);
  const auto reds = [&](std::uint32_t codes) {
    std::vector<Level> levels{ramp()};
    quantize_groups(levels, codes, pool);
    std::vector<int> row;
    for (std::size_t x = 0; x < 8; ++x) row.push_back(levels[0].rgba[4 * x]);
    return row;
  };
  EXPECT_EQ(reds(1), (std::vector{101, 101, 103, 103, 105, 105, 107, 107})) << "by groups: 100 and 101 in one";
  EXPECT_EQ(reds(2), (std::vector{102, 102, 102, 102, 106, 106, 106, 106})) << "by octants";
  EXPECT_EQ(reds(4), (std::vector(8, 104))) << "the whole brick";
}

/// A device computes the voxels of a group; the host computes the group of a voxel. The two mappings must agree.
TEST(Approximate, NumbersTheVoxelsOfAGroupFromItsLowestOn) {
  std::array<int, brick_voxels> seen{};
  for (unsigned group = 0; group < groups_per_brick; ++group)
    for (const unsigned further : {0u, 1u, 8u, 9u, 64u, 65u, 72u, 73u}) {
      const unsigned voxel = lowest_voxel_of(group) + further;
      EXPECT_EQ(group_of(voxel), group);
      EXPECT_EQ(group_share(int(voxel)), int(9 + group));
      EXPECT_EQ(octant_share(int(9 + group)), int(1 + group / 8));
      ++seen[voxel];
    }
  EXPECT_TRUE(std::ranges::all_of(seen, [](int times) { return times == 1; }));
}

/// Joined ranges, including empty ones, equal the range of all values.
TEST(Approximate, JoinsRangesToThatOfAll) {
  const gigabake::test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (int round = 0; round < 2000; ++round) {
    CodeRange codes[3], all_codes;
    NormalRange normals[3], all_normals;
    for (std::uint64_t n = rng() % 12; n > 0; --n) {
      const auto part = rng() % 3;
      const auto code = std::uint8_t(rng());
      codes[part].add(code), all_codes.add(code);
      Vec3<std::int16_t> unit;
      for (std::int16_t& axis : unit) axis = std::int16_t(int(rng() % 65535) - 32767);
      normals[part].add(unit), all_normals.add(unit);
    }
    for (const int part : {1, 2}) codes[0].join(codes[part]), normals[0].join(normals[part]);
    EXPECT_EQ(std::tuple(codes[0].low, codes[0].high, codes[0].sum),
              std::tuple(all_codes.low, all_codes.high, all_codes.sum));
    EXPECT_EQ(normals[0].low, all_normals.low);
    EXPECT_EQ(normals[0].high, all_normals.high);
  }
}

}  // namespace
}  // namespace gigabake::kernels
