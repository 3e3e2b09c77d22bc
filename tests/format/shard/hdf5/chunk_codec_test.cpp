#include "format/shard/hdf5/chunk_codec.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

#include "tests/random_seed.h"

namespace gigabake {
namespace {

constexpr ChunkFilters all_filters[] = {{Codec::lz4, 1},     {Codec::lz4, 4},     {Codec::lz4, 8},
                                        {Codec::deflate, 1}, {Codec::deflate, 4}, {Codec::deflate, 8}};

/// Returns increasing 64-bit numbers, noise, or bytes of three different values.
std::vector<std::uint8_t> made_chunk(std::mt19937_64& rng, std::size_t bytes) {
  std::vector<std::uint8_t> chunk(bytes);
  const std::uint64_t kind = rng() % 3;
  std::uint64_t number = rng() % 1000;
  for (std::size_t i = 0; i < bytes; ++i) {
    if (i % 8 == 0) number += rng() % 300;
    chunk[i] = std::uint8_t(kind == 0 ? number >> 8 * (i % 8) : kind == 1 ? rng() : rng() % 3);
  }
  return chunk;
}

TEST(ChunkCodec, GivesBackWhatItWasGivenAndAnyBeginningOfIt) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (int round = 0; round < 60; ++round)
    for (const ChunkFilters& filters : all_filters) {
      const std::vector<std::uint8_t> chunk = made_chunk(rng, 8 * (1 + rng() % 5000));
      const std::vector<std::uint8_t> stored = encode_chunk(chunk, filters);
      std::vector<std::uint8_t> back(round % 2 == 0 ? chunk.size() : 8 * (1 + rng() % (chunk.size() / 8)));
      ASSERT_TRUE(decode_chunk(stored, filters, chunk.size(), back));
      EXPECT_TRUE(std::equal(back.begin(), back.end(), chunk.begin()));
    }
}

TEST(ChunkCodec, RefusesChunksWithAnyBitChangedOrOfAnotherSize) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (const ChunkFilters& filters : all_filters) {
    const std::vector<std::uint8_t> chunk = made_chunk(rng, 4096), stored = encode_chunk(chunk, filters);
    std::vector<std::uint8_t> back(chunk.size()), longer(chunk.size() + 8);
    for (int round = 0; round < 200; ++round) {
      std::vector<std::uint8_t> damaged = stored;
      damaged[rng() % damaged.size()] ^= std::uint8_t(1 << rng() % 8);
      EXPECT_FALSE(decode_chunk(damaged, filters, chunk.size(), back));
    }
    EXPECT_FALSE(decode_chunk(stored, filters, longer.size(), longer));
    EXPECT_FALSE(decode_chunk(stored, filters, chunk.size() - 8, {back.data(), back.size() - 8}));
    EXPECT_FALSE(decode_chunk({stored.data(), stored.size() - 1}, filters, chunk.size(), back));
  }
}

TEST(ChunkCodec, StoresRisingNumbersInAFractionOfTheirBytesPlaneByPlane) {
  std::mt19937_64 rng(7);
  std::vector<std::uint64_t> rising(16384);
  for (std::size_t i = 1; i < rising.size(); ++i) rising[i] = rising[i - 1] + rng() % 128;
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(rising.data()), 8 * rising.size());
  for (const Codec codec : {Codec::lz4, Codec::deflate})
    EXPECT_LT(1.3 * double(encode_chunk(bytes, {codec, 8}).size()), double(encode_chunk(bytes, {codec, 1}).size()));
}

}  // namespace
}  // namespace gigabake
