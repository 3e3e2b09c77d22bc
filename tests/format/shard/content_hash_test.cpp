#include "format/shard/levels/content_hash.h"

#define XXH_INLINE_ALL
#include <cstring>
#include <gtest/gtest.h>
#include <random>
#include <xxhash.h>

#include "made_shard.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using made::Voxel;

std::vector<Voxel> random_voxels(std::mt19937_64& rng, std::int64_t edge, int count) {
  std::vector<Voxel> voxels;
  for (int i = 0; i < count; ++i) {
    Voxel v;
    for (std::int64_t& x : v.at) x = std::int64_t(rng() % std::uint64_t(edge)) - edge / 2;
    for (std::uint8_t& c : v.rgba) c = std::uint8_t(1 + rng() % 255);
    for (std::int8_t& c : v.normal) c = std::int8_t(rng() % 128);
    const bool is_new = std::none_of(voxels.begin(), voxels.end(), [&](const Voxel& o) { return o.at == v.at; });
    if (is_new) voxels.push_back(v);
  }
  return voxels;
}

/// Returns the hash of a voxel by the contract in content_hash.h. Shares no code with the library.
Hash128 contract(int lod, const Voxel& v) {
  unsigned char bytes[34];
  for (int i = 0; i < 4; ++i) bytes[i] = (unsigned char)(std::uint32_t(lod) >> (8 * i));
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 8; ++i) bytes[4 + 8 * c + i] = (unsigned char)(std::uint64_t(v.at[std::size_t(c)]) >> (8 * i));
  std::memcpy(bytes + 28, v.rgba.data(), 4);
  std::memcpy(bytes + 32, v.normal.data(), 2);
  const XXH128_hash_t h = XXH3_128bits(bytes, 34);
  return {h.low64, h.high64};
}

TEST(ContentHash, IsTheSumOverItsVoxelsAsTheHeaderSays) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const std::vector<Voxel> voxels = random_voxels(rng, 64, 700);
  unsigned __int128 sum = 0;
  for (const Voxel& v : voxels) {
    const Hash128 h = contract(0, v);
    sum += (unsigned __int128)(h.hi) << 64 | h.lo;
  }
  const Hash128 expected{std::uint64_t(sum), std::uint64_t(sum >> 64)};
  EXPECT_EQ(content_hash(made::shard_of(voxels, {-32, -32, -32}, 64))[0], expected);
}

TEST(ContentHash, DoesNotShowHowCellsAreCutNorHowManyThreadsHash) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const std::vector<Voxel> voxels = random_voxels(rng, 64, 900);
  const Hash128 whole = content_hash(made::shard_of(voxels, {-32, -32, -32}, 64))[0];
  Hash128 sum;
  for (std::int64_t z = -32; z < 32; z += 32)
    for (std::int64_t y = -32; y < 32; y += 32)
      for (std::int64_t x = -32; x < 32; x += 32) sum += content_hash(made::shard_of(voxels, {x, y, z}, 32), 3)[0];
  EXPECT_EQ(whole, sum);
}

TEST(ContentHash, TellsLevelPlaceColourAlphaNormalAndFacingApart) {
  const Voxel voxel{{8, -16, 24}, {1, 2, 3, 4}, {5, 6}};
  const auto hash = [](int lod, const Voxel& v) { return voxel_hash(lod, v.at, v.rgba.data(), v.normal.data()); };
  const Hash128 h = hash(0, voxel);
  EXPECT_NE(h, hash(1, voxel));
  for (std::size_t c = 0; c < 3; ++c) {
    Voxel other = voxel;
    ++other.at[c];
    EXPECT_NE(h, hash(0, other));
  }
  for (std::size_t c = 0; c < 4; ++c) {
    Voxel other = voxel;
    ++other.rgba[c];
    EXPECT_NE(h, hash(0, other));
  }
  Voxel turned = voxel;
  ++turned.normal[1];
  EXPECT_NE(h, hash(0, turned));
  const std::uint8_t directional_coverage[directional_coverage_bytes] = {},
                     other[directional_coverage_bytes] = {0, 0, 0, 1};
  const Hash128 faced = voxel_hash(1, voxel.at, voxel.rgba.data(), voxel.normal.data(), directional_coverage);
  EXPECT_NE(faced, hash(1, voxel));
  EXPECT_NE(faced, voxel_hash(1, voxel.at, voxel.rgba.data(), voxel.normal.data(), other));
}

TEST(ContentHash, OfAConstantBranchIsThatOfTheVoxelsItStandsFor) {
  std::vector<Voxel> solid;
  for (std::int64_t z = 0; z < 16; ++z)
    for (std::int64_t y = 0; y < 16; ++y)
      for (std::int64_t x = 0; x < 16; ++x) solid.push_back({{x, y, z}, {10, 20, 30, 255}, {3, 4}});
  const Shard written_out = made::shard_of(solid, {0, 0, 0}, 16);
  Shard constant = written_out;
  constant.nodes = {{0}, {1}, {NodeKind::leaf_constant}, {0}, {0xffffffffu}, {0xff1e140au}, {{3, 4}}, {}};
  for (BrickLevel& level : constant.levels) level = {{}, {0}, {}, {}, {}};
  EXPECT_EQ(content_hash(written_out), content_hash(constant));
}

TEST(Hash128, ComesBackFromItsHexadecimalText) {
  const Hash128 h{0x0123456789abcdefu, 0xfedcba9876543210u};
  EXPECT_EQ(h.hex(), "fedcba98765432100123456789abcdef");
  EXPECT_EQ(Hash128::from_hex(h.hex()), h);
  for (const char* bad : {"", "0123", "FEDCBA98765432100123456789ABCDEF", "fedcba98765432100123456789abcdeg",
                          "fedcba98765432100123456789abcdef0"})
    EXPECT_EQ(Hash128::from_hex(bad), std::nullopt) << bad;
}

TEST(Hash128, AddsWithCarryModulo2To128) {
  Hash128 h{~std::uint64_t(0), 1};
  h += Hash128{1, 0};
  EXPECT_EQ(h, (Hash128{0, 2}));
  h += Hash128{0, ~std::uint64_t(0)};
  EXPECT_EQ(h, (Hash128{0, 1}));
}

}  // namespace
}  // namespace gigabake
