#include "format/shard/columns/shared_values.h"

#include <algorithm>
#include <array>
#include <bit>
#include <gtest/gtest.h>
#include <map>
#include <random>

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

/// A channel as a shard stores it.
struct Stored {
  std::vector<std::uint8_t> value, share;
  std::vector<std::uint64_t> first;
};

std::vector<std::uint8_t> spread(const Made& made, const Stored& shared, std::size_t width) {
  std::vector<std::uint8_t> out(made.bytes.size());
  for (std::size_t b = 0; b + 1 < made.first.size(); ++b) {
    const std::span values(&shared.value[shared.first[b] * width], (shared.first[b + 1] - shared.first[b]) * width);
    EXPECT_TRUE(spread_values(&made.mask[8 * b], &shared.share[share_bytes * b], values, width,
                              {&out[made.first[b] * width], width}));
  }
  return out;
}

/// Deduplicates the values, and collects the remaining values in pieces of `piece` values.
Stored share(const Made& made, std::size_t width, int threads, std::size_t piece = 1u << 30) {
  const ThreadPool pool = ThreadPool(threads);
  const VoxelGroups groups = group_voxels(made.mask, made.first, pool);
  const SharedValues shared(groups, made.first, {made.bytes.data(), width}, width, pool);
  Stored out{std::vector<std::uint8_t>(shared.count() * width), shared.share(), shared.first()};
  for (std::size_t at = 0; at < shared.count(); at += piece)
    shared.collect(at, std::span(out.value).subspan(at * width, std::min(piece, shared.count() - at) * width));
  return out;
}

/// Returns the number of values that spread_values() requires for a brick.
std::size_t count_values(const std::uint64_t* mask, const std::uint8_t* share) {
  std::array<std::uint8_t, brick_voxels> out;
  std::size_t values = 1;
  while (values <= brick_voxels && !spread_values(mask, share, std::vector<std::uint8_t>(values), 1, {out.data(), 1}))
    ++values;
  return values;
}

TEST(SharedValues, GiveEveryVoxelItsOwnBytesBack) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  int shared_rounds = 0;
  for (int round = 0; round < 200; ++round) {
    const std::size_t width = 1 + rng() % 4;
    const Made made = made_bricks(rng, 1 + rng() % 20, width);
    const Stored shared = share(made, width, 1 + int(rng() % 3));
    if (shared.share.empty()) {
      std::vector<std::uint8_t> plain = shared.value;
      while (shared.value.size() == width && plain.size() < made.bytes.size())
        plain.insert(plain.end(), shared.value.begin(), shared.value.end());
      EXPECT_EQ(plain, made.bytes);
      continue;
    }
    ++shared_rounds;
    EXPECT_EQ(shared.value.size(), shared.first.back() * width);
    EXPECT_LT(shared.value.size() + shared.share.size(), made.bytes.size() * 3 / 4);
    for (std::size_t b = 0; b + 1 < made.first.size(); ++b)
      EXPECT_EQ(shared.first[b + 1] - shared.first[b], count_values(&made.mask[8 * b], &shared.share[share_bytes * b]));
    EXPECT_EQ(spread(made, shared, width), made.bytes);
  }
  EXPECT_GT(shared_rounds, 20);
}

/// Chunks of a shard end where they are full, also within bricks.
TEST(SharedValues, AreTheSameCollectedInAnyPieces) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (int round = 0; round < 100; ++round) {
    const std::size_t width = 1 + rng() % 4;
    const Made made = made_bricks(rng, 1 + rng() % 20, width);
    const std::vector<std::uint8_t> whole = share(made, width, 1).value;
    for (const std::size_t piece : {std::size_t(1), 1 + std::size_t(rng() % 40), 1 + std::size_t(rng() % 1000)})
      EXPECT_EQ(share(made, width, 1, piece).value, whole) << "pieces of " << piece;
  }
}

TEST(SharedValues, AreOneWhereAllVoxelsAreAlike) {
  const Made made{
      std::vector<std::uint64_t>(16, 0xff00ff00ff00ff00u), {0, 256, 512}, std::vector<std::uint8_t>(3 * 512, 77)};
  const Stored shared = share(made, 3, 1);
  EXPECT_EQ(shared.value, std::vector<std::uint8_t>(3, 77));
  EXPECT_TRUE(shared.share.empty());
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
