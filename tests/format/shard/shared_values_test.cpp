#include "format/shard/columns/shared_values.h"

#include <algorithm>
#include <array>
#include <bit>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <set>

#include "tests/random_seed.h"

namespace gigabake {
namespace {

/// Bricks in which values repeat by groups, by octants, by bricks, or not at all.
struct Made {
  std::vector<std::uint64_t> mask, first{0};
  std::vector<std::uint8_t> bytes;
};

Made made_bricks(std::mt19937_64& rng, std::size_t bricks, std::size_t width) {
  Made made;
  for (std::size_t b = 0; b < bricks; ++b) {
    const unsigned shift = unsigned(rng() % 4);  // log2 of the edge of cubes of equal values
    std::map<unsigned, std::uint8_t> value;
    std::uint64_t voxels = 0;
    for (unsigned z = 0; z < 8; ++z) {
      const std::uint64_t word = z == 0 ? rng() | 1 : rng() & rng();
      made.mask.push_back(word);
      voxels += std::uint64_t(std::popcount(word));
      for (std::uint64_t rest = word; rest != 0; rest &= rest - 1) {
        const auto bit = unsigned(std::countr_zero(rest));
        const unsigned place = (bit & 7) >> shift | (bit >> 3) >> shift << 3 | z >> shift << 6;
        if (!value.contains(place)) value[place] = std::uint8_t(rng());
        for (std::size_t i = 0; i < width; ++i) made.bytes.push_back(std::uint8_t(value[place] + 7 * i));
      }
    }
    made.first.push_back(made.first.back() + voxels);
  }
  return made;
}

/// Returns the number of values that spread_values() requires for a brick.
std::size_t count_values(const std::uint64_t* mask, const std::uint8_t* share) {
  std::array<std::uint8_t, brick_voxels> out;
  std::size_t values = 1;
  while (values <= brick_voxels && !spread_values(mask, share, std::vector<std::uint8_t>(values), 1, {out.data(), 1}))
    ++values;
  return values;
}

/// A brick's values as shards of versions 2 to 6 store them.
struct Stored {
  std::array<std::uint8_t, share_bytes> share = {};
  std::vector<std::uint8_t> value;
};

/// Shares the values of a brick by the definition of docs/format.md. `bytes` has `width` bytes per voxel.
Stored share(const std::uint64_t* mask, const std::uint8_t* bytes, std::size_t width) {
  std::map<unsigned, std::set<std::vector<std::uint8_t>>> brick, octants, groups;
  std::vector<std::pair<unsigned, std::vector<std::uint8_t>>> voxels;
  for (unsigned place = 0; place < brick_voxels; ++place) {
    if ((mask[place / 64] >> place % 64 & 1) == 0) continue;
    const std::vector<std::uint8_t> value(bytes + voxels.size() * width, bytes + (voxels.size() + 1) * width);
    const unsigned group = group_of(place);
    brick[0].insert(value), octants[group / 8].insert(value), groups[group].insert(value);
    voxels.emplace_back(group, value);
  }
  Stored out;
  for (const auto& [group, values] : groups)
    out.share[group / 8] = std::uint8_t(out.share[group / 8] | unsigned(values.size() == 1) << group % 8);
  for (const auto& [octant, values] : octants)
    out.share[8] = std::uint8_t(out.share[8] | unsigned(values.size() == 1) << octant);
  out.share[9] = brick[0].size() == 1;
  std::set<unsigned> stored;
  for (const auto& [group, value] : voxels) {
    const bool in_octant = octants[group / 8].size() == 1, in_group = groups[group].size() == 1;
    const unsigned set = out.share[9] != 0 ? 1000 : in_octant ? 100 + group / 8 : group;
    if ((out.share[9] != 0 || in_octant || in_group) && !stored.insert(set).second) continue;
    out.value.insert(out.value.end(), value.begin(), value.end());
  }
  return out;
}

TEST(SharedValues, GiveEveryVoxelItsOwnBytesBack) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  std::size_t shared = 0;
  for (int round = 0; round < 400; ++round) {
    const std::size_t width = 1 + rng() % 4;
    const Made made = made_bricks(rng, 1 + rng() % 20, width);
    for (std::size_t b = 0; b + 1 < made.first.size(); ++b) {
      const std::uint8_t* bytes = &made.bytes[made.first[b] * width];
      const std::size_t voxels = made.first[b + 1] - made.first[b];
      const Stored stored = share(&made.mask[8 * b], bytes, width);
      std::vector<std::uint8_t> back(voxels * width);
      ASSERT_TRUE(spread_values(&made.mask[8 * b], stored.share.data(), stored.value, width, {back.data(), width}));
      EXPECT_TRUE(std::equal(back.begin(), back.end(), bytes)) << "round " << round << ", brick " << b;
      EXPECT_EQ(count_values(&made.mask[8 * b], stored.share.data()), stored.value.size() / width);
      shared += stored.value.size() < back.size() ? 1 : 0;
    }
  }
  EXPECT_GT(shared, 500u);
}

TEST(SharedValues, OfANewBrickOctantOrGroupStandWhereItsFirstVoxelWould) {
  const std::uint64_t mask[8] = {0x0303, 0, 0, 0, 0x30, 0, 0, 0};  // a group of four voxels, and two of another octant
  std::uint8_t share[share_bytes] = {1, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(count_values(mask, share), 3u);
  share[8] = 1 << 5;
  EXPECT_EQ(count_values(mask, share), 2u);
  std::uint8_t out[6];
  const std::vector<std::uint8_t> value{4, 9};
  EXPECT_TRUE(spread_values(mask, share, value, 1, {out, 1}));
  EXPECT_TRUE(std::equal(out, out + 6, std::initializer_list<std::uint8_t>{4, 4, 4, 4, 9, 9}.begin()));
  for (const std::size_t wrong : {0, 1, 3})
    EXPECT_FALSE(spread_values(mask, share, std::vector<std::uint8_t>(wrong), 1, {out, 1})) << wrong;
  share[9] = 1;
  EXPECT_EQ(count_values(mask, share), 1u);
}

}  // namespace
}  // namespace gigabake
