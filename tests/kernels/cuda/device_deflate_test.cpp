// Chunks that a device packs have the same bytes as those that the host packs. The tests are skipped, with a message,
// if there is no GPU.
#include <gtest/gtest.h>
#include <numeric>

#include "format/shard/hdf5/chunk_codec.h"
#include "kernels/cuda/baker.h"
#include "kernels/pack/device_pack.h"
#include "tests/format/shard/hdf5/made_bytes.h"
#include "tests/random_seed.h"

namespace gigabake::kernels {
namespace {

/// Chunks of any bytes with gaps between them, packed on a device in one call.
class DeviceDeflate : public testing::Test {
 protected:
  void SetUp() override {
    const CudaDevices devices = cuda_devices();
    if (devices.usable.empty()) GTEST_SKIP() << devices.reason;
    device_ = devices.usable.front();
  }

  void add(const std::string& name, const gigabake::test::Bytes& bytes, std::uint32_t element_bytes = 1,
           std::uint32_t min_match_bytes = deflate::min_match) {
    raw_.resize(raw_.size() + names_.size() % 3);  // chunks begin at any address
    chunks_.push_back({raw_.size(), std::uint32_t(bytes.size()), element_bytes, min_match_bytes});
    raw_.insert(raw_.end(), bytes.begin(), bytes.end());
    names_.push_back(name + ", " + std::to_string(bytes.size()) + " bytes of " + std::to_string(element_bytes));
  }

  void expect_the_hosts_bytes() const {
    const DevicePacked packed = pack_on_device(device_, raw_, chunks_, 1);
    ASSERT_EQ(packed.ends.size(), chunks_.size());
    for (std::size_t c = 0, begin = 0; c < chunks_.size(); begin = packed.ends[c], ++c) {
      const std::span<const std::uint8_t> raw(raw_.data() + chunks_[c].begin, chunks_[c].bytes);
      const gigabake::test::Bytes host =
          encode_chunk(raw, {Codec::deflate, chunks_[c].element_bytes, chunks_[c].min_match_bytes});
      const std::span<const std::uint8_t> device(packed.bytes.data() + begin, packed.ends[c] - begin);
      const auto [at, there] = std::mismatch(host.begin(), host.end(), device.begin(), device.end());
      ASSERT_TRUE(at == host.end() && there == device.end())
          << names_[c] << ": " << host.size() << " bytes on the host, " << device.size()
          << " on the device, which differ from byte " << at - host.begin() << " on";
    }
  }

  int device_ = 0;
  gigabake::test::Bytes raw_;
  std::vector<RawChunk> chunks_;
  std::vector<std::string> names_;
};

TEST_F(DeviceDeflate, MakesTheHostsBytesWhateverTheBytesAndTheirNumber) {
  const gigabake::test::RandomSeed seed;
  gigabake::test::Random rng(seed);
  for (const std::size_t size : gigabake::test::awkward_sizes())
    for (const gigabake::test::NamedBytes& made : gigabake::test::made_bytes(rng, size)) add(made.name, made.bytes);
  expect_the_hosts_bytes();
}

TEST_F(DeviceDeflate, MakesTheHostsBytesOfShuffledElements) {
  const gigabake::test::RandomSeed seed;
  gigabake::test::Random rng(seed);
  for (const std::uint32_t element : {2u, 4u, 8u})
    for (int round = 0; round < 20; ++round)
      add("rising numbers", gigabake::test::rising(rng, 8 * (rng() % 20000)), element);
  expect_the_hosts_bytes();
}

TEST_F(DeviceDeflate, MakesTheHostsBytesOfLongMatchesOnlyAndOfRowsOfThreeBytes) {
  const gigabake::test::RandomSeed seed;
  gigabake::test::Random rng(seed);
  for (const std::size_t size : gigabake::test::awkward_sizes())
    for (const gigabake::test::NamedBytes& made : gigabake::test::made_bytes(rng, size)) {
      add(made.name, made.bytes, 1, 8);
      if (size % 3 == 0) add(made.name, made.bytes, 3, 12);
    }
  add("noise in rows", gigabake::test::noise(rng, 3 * 43690, 20), 3, 12);
  expect_the_hosts_bytes();
}

TEST_F(DeviceDeflate, MakesTheHostsBytesOfOneChunkOfOneByteAndOfNoChunk) {
  add("one byte", {7});
  expect_the_hosts_bytes();
  EXPECT_TRUE(pack_on_device(device_, {}, {}, 1).bytes.empty());
}

TEST_F(DeviceDeflate, RefusesAChunkThatIsTooLarge) {
  chunks_.push_back({0, max_packed_chunk_bytes + 1, 1});
  EXPECT_THROW(pack_on_device(device_, raw_, chunks_, 1), CudaFailure);
}

}  // namespace
}  // namespace gigabake::kernels
