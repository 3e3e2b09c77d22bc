// The zlib frame of a chunk: every deflate reader decodes it, and its bytes never change.
#include "format/shard/hdf5/deflate_chunk.h"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <libdeflate.h>
#include <map>
#include <set>
#include <string>

#include "core/codec/block_codes.h"
#include "core/codec/matches.h"
#include "core/codec/stored_chunk.h"
#include "tests/format/shard/hdf5/made_bytes.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using test::Bytes;

Bytes framed(Bytes bytes, std::uint32_t min_match_bytes = deflate::min_match) {
  const std::size_t size = bytes.size();
  bytes.resize(size + deflate::readable_beyond, 0xee);
  return zlib_frame({bytes.data(), size}, min_match_bytes, 0);
}

/// Decompresses a frame with libdeflate, which also checks the checksum. Returns an empty array if that fails.
Bytes unframed(const Bytes& frame, std::size_t size) {
  libdeflate_decompressor* reader = libdeflate_alloc_decompressor();
  Bytes bytes(size + 1);
  std::size_t read = 0;
  const auto result = libdeflate_zlib_decompress(reader, frame.data(), frame.size(), bytes.data(), bytes.size(), &read);
  libdeflate_free_decompressor(reader);
  bytes.resize(result == LIBDEFLATE_SUCCESS ? read : 0);
  return bytes;
}

std::size_t level_1_size(const Bytes& bytes) {
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(1);
  Bytes room(libdeflate_zlib_compress_bound(compressor, bytes.size()));
  const std::size_t size = libdeflate_zlib_compress(compressor, bytes.data(), bytes.size(), room.data(), room.size());
  libdeflate_free_compressor(compressor);
  return size;
}

TEST(DeflateChunk, IsReadBackWhateverTheBytesAndTheirNumber) {
  const test::RandomSeed seed;
  test::Random rng(seed);
  for (const std::size_t size : test::awkward_sizes())
    for (const test::NamedBytes& made : test::made_bytes(rng, size)) {
      const Bytes frame = framed(made.bytes);
      ASSERT_EQ(unframed(frame, size), made.bytes) << made.name << ", " << size;
      ASSERT_LE(frame.size(), size + 5 * (size / 65535 + 1) + 6) << made.name << ", " << size;
    }
}

TEST(DeflateChunk, IsReadBackForRandomSizesAndMixtures) {
  const test::RandomSeed seed;
  test::Random rng(seed);
  for (int round = 0; round < 60; ++round) {
    Bytes bytes;
    for (std::size_t parts = 1 + rng() % 6; parts > 0; --parts) {
      const auto all = test::made_bytes(rng, rng() % 40000);
      const Bytes& part = all[rng() % all.size()].bytes;
      bytes.insert(bytes.end(), part.begin(), part.end());
    }
    ASSERT_EQ(unframed(framed(bytes), bytes.size()), bytes) << "round " << round;
  }
}

TEST(DeflateChunk, WithLongMatchesOnlyIsReadBackAndTakesLessForNoise) {
  const test::RandomSeed seed;
  test::Random rng(seed);
  for (const std::size_t size : test::awkward_sizes())
    for (const test::NamedBytes& made : test::made_bytes(rng, size))
      for (const std::uint32_t min_match_bytes : {8u, 12u, 300u})
        ASSERT_EQ(unframed(framed(made.bytes, min_match_bytes), size), made.bytes) << made.name << ", " << size;
  const Bytes noise = test::noise(rng, 1 << 17, 4);
  EXPECT_LT(framed(noise, 12).size(), framed(noise).size());
}

TEST(DeflateChunk, TakesHardlyMoreThanLibdeflateOfWhatShardsHold) {
  const test::RandomSeed seed;
  test::Random rng(seed);
  for (const Bytes& bytes : {test::colours(rng, 1 << 17), test::runs(rng, 1 << 17, 20), test::noise(rng, 1 << 17, 40)})
    EXPECT_LE(double(framed(bytes).size()), 1.02 * double(level_1_size(bytes)));
  // Nearly constant data is packed to almost nothing except for a header per block.
  const Bytes alike = test::periodic(rng, 1 << 17, 640);
  EXPECT_LE(framed(alike).size(), level_1_size(alike) + 4 * 100);
}

/// Shards are compared byte by byte, and a device must make the same bytes. The packed bytes therefore change only on
/// purpose. Such a change needs a CHANGELOG entry and new numbers in this test.
TEST(DeflateChunk, MakesTheBytesThatItAlwaysMade) {
  test::Random rng(20261123);
  std::string sizes;
  Bytes all;
  for (const std::size_t size : {1u, 1000u, 131072u, 200001u})
    for (const test::NamedBytes& made : test::made_bytes(rng, size)) {
      // std::shuffle may differ from one library to the next.
      if (made.name == "Fibonacci counts") continue;
      const Bytes frame = framed(made.bytes);
      all.insert(all.end(), frame.begin(), frame.end());
    }
  EXPECT_EQ(all.size(), 3638771u);
  EXPECT_EQ(libdeflate_crc32(0, all.data(), all.size()), 906546101u);
  const std::string small = "voxel voxel voxel voxels";
  const Bytes frame{0x78, 0x01, 0x65, 0xc4, 0xb1, 0x09, 0x00, 0x00, 0x0c, 0x02, 0xb0, 0x57, 0xfa, 0x5c, 0x37, 0xc1,
                    0x41, 0x10, 0xcf, 0xf7, 0x00, 0x33, 0xc4, 0xcc, 0xe3, 0x66, 0x15, 0x77, 0x3b, 0x09, 0x8c};
  EXPECT_EQ(framed(Bytes(small.begin(), small.end())), frame);
}

/// Expects the candidates to be those that the header defines. The reference compares all earlier positions of a
/// bucket.
TEST(DeflateCandidates, AreTheLatestPositionsOfTheBucketWithinReach) {
  const test::RandomSeed seed;
  test::Random rng(seed);
  for (const Bytes& bytes : {test::periodic(rng, 300000, 40000), test::noise(rng, 300000, 3),
                             test::runs(rng, 300000, 9000), test::colours(rng, 300000)}) {
    std::vector<deflate::Bucket> table(deflate::buckets, deflate::empty_bucket(0));
    std::map<std::uint32_t, std::int64_t> latest;
    for (std::uint32_t p = 0; p + 4 <= bytes.size(); ++p) {
      if (p % deflate::block_bytes == 0)
        for (deflate::Bucket& b : table) b = deflate::aged(b, p);
      const std::uint32_t bucket = deflate::bucket_of(deflate::four_bytes(&bytes[p]));
      const std::int64_t exact = p - latest.try_emplace(bucket, -100000).first->second;
      const std::uint32_t found = deflate::distance_to(table[bucket], p);
      ASSERT_EQ(deflate::in_reach(found), exact <= deflate::max_distance) << p;
      if (deflate::in_reach(found)) {
        ASSERT_EQ(found, exact) << p;
      }
      table[bucket] = deflate::bucket_with(p);
      latest[bucket] = p;
    }
  }
}

TEST(DeflateSymbols, AreThoseOfTheSpecification) {
  // RFC 1951, 3.2.5, states the bases and extra bits. The test checks the first and last value of symbols.
  for (std::uint32_t length = 3, last = 0; length <= 258; ++length) {
    const auto s = deflate::symbol_of_length(length);
    ASSERT_TRUE(s.symbol == last || s.symbol == last + 1 || last == 0) << length;
    ASSERT_EQ(s.symbol == last ? s.bits : 0u, s.bits) << length;
    last = s.symbol;
  }
  EXPECT_EQ(deflate::symbol_of_length(3).symbol, 257u);
  EXPECT_EQ(deflate::symbol_of_length(257).symbol, 284u);
  EXPECT_EQ(deflate::symbol_of_length(257).bits, 30u);
  EXPECT_EQ(deflate::symbol_of_length(258).symbol, 285u);
  EXPECT_EQ(deflate::symbol_of_distance(1).symbol, deflate::literal_symbols);
  EXPECT_EQ(deflate::symbol_of_distance(24577).symbol, deflate::literal_symbols + 29);
  EXPECT_EQ(deflate::symbol_of_distance(32768).bits, 8191u);
}

/// Returns the code lengths of the symbols that occur, with ties resolved as in gigabake.
std::vector<std::uint8_t> lengths_of(const std::vector<std::uint32_t>& counts, std::uint32_t maximum) {
  std::vector<std::uint32_t> keys, weights(counts.size());
  for (std::uint32_t s = 0; s < counts.size(); ++s)
    if (counts[s] != 0) keys.push_back(deflate::order_key(counts[s], s));
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint8_t> lengths(counts.size());
  deflate::code_lengths(keys.data(), int(keys.size()), maximum, weights.data(), lengths.data());
  return lengths;
}

/// Returns the minimum number of bits of a Huffman code for these counts, computed with a queue of weights.
std::uint64_t min_bits(const std::vector<std::uint32_t>& counts) {
  std::multiset<std::uint64_t> weights;
  for (const std::uint32_t c : counts)
    if (c != 0) weights.insert(c);
  std::uint64_t bits = 0;
  while (weights.size() > 1) {
    const std::uint64_t pair = *weights.begin() + *std::next(weights.begin());
    weights.erase(weights.begin(), std::next(weights.begin(), 2));
    weights.insert(pair);
    bits += pair;
  }
  return bits;
}

TEST(CodeLengths, AreCompleteWithinTheLimitAndMinimalWhereItDoesNotBind) {
  const test::RandomSeed seed;
  test::Random rng(seed);
  for (int round = 0; round < 3000; ++round) {
    const std::uint32_t maximum = round % 3 == 0 ? 7 : 15, symbols = maximum == 7 ? 19 : 286;
    std::vector<std::uint32_t> counts(symbols);
    const unsigned spread = 1 + rng() % 15;
    for (std::uint32_t& c : counts) c = rng() % 3 == 0 ? 0 : std::uint32_t(rng() % (1u << rng() % spread));
    deflate::ensure_two(counts.data(), symbols);
    const auto lengths = lengths_of(counts, maximum);
    std::uint64_t taken = 0, bits = 0;
    for (std::uint32_t s = 0; s < symbols; ++s) {
      ASSERT_EQ(lengths[s] == 0, counts[s] == 0);
      ASSERT_LE(lengths[s], maximum);
      if (lengths[s] != 0) taken += 1u << (maximum - lengths[s]);
      bits += std::uint64_t(lengths[s]) * counts[s];
    }
    ASSERT_EQ(taken, 1u << maximum) << "round " << round;
    if (*std::max_element(lengths.begin(), lengths.end()) < maximum) {
      ASSERT_EQ(bits, min_bits(counts)) << "round " << round;
    }
  }
}

TEST(CodeLengths, OfFibonaccisCountsStayAtTheLimit) {
  std::vector<std::uint32_t> counts(24, 1);
  for (std::size_t i = 2; i < counts.size(); ++i) counts[i] = counts[i - 1] + counts[i - 2];
  const auto lengths = lengths_of(counts, 15);
  std::uint32_t taken = 0;
  for (const std::uint8_t l : lengths) taken += 1u << (15 - l);
  EXPECT_EQ(taken, 1u << 15);
  EXPECT_EQ(lengths.back(), 1);
  EXPECT_EQ(*std::max_element(lengths.begin(), lengths.end()), 15);
}

TEST(DoubleSums, OfPiecesAreThoseOfTheWhole) {
  const test::RandomSeed seed;
  test::Random rng(seed);
  for (const std::size_t size : test::awkward_sizes()) {
    const Bytes bytes = test::noise(rng, size, rng() % 2 == 0 ? 256 : 1);
    std::array<deflate::Adler, 5> pieces{};
    for (std::uint32_t i = 0; i < size; ++i) pieces[rng() % 5].add(bytes[i], std::uint32_t(size) - 1 - i);
    deflate::Adler whole{};
    for (deflate::Adler& piece : pieces) whole.join(piece);
    EXPECT_EQ(deflate::adler32_of(whole, std::uint32_t(size)), libdeflate_adler32(1, bytes.data(), size)) << size;
  }
}

}  // namespace
}  // namespace gigabake
