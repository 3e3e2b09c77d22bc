#include "worker/pipeline/worker_setup.h"

#include <gtest/gtest.h>
#include <random>

#include "core/base/error.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

WorkerSetup some_setup() {
  WorkerSetup s;
  s.parameters = {0.1, {1.0 / 3, -2, 3e5}, 512, SurfaceRule::thin, MipFilter::box, false};
  s.worker = {7, std::uint64_t(5) << 33, "/shared/out", {}, true, true, "/local/scratch"};
  s.device = {Backend::cuda, {4, 1}, 9, 12};
  return s;
}

void expect_equal(const WorkerSetup& a, const WorkerSetup& b) {
  EXPECT_EQ(to_json(a.parameters), to_json(b.parameters));
  EXPECT_EQ(a.parameters.lattice_origin_m, b.parameters.lattice_origin_m);
  EXPECT_EQ(a.worker.threads, b.worker.threads);
  EXPECT_EQ(a.worker.memory_bytes, b.worker.memory_bytes);
  EXPECT_EQ(a.worker.out, b.worker.out);
  EXPECT_EQ(a.worker.threads_are_a_share, b.worker.threads_are_a_share);
  EXPECT_EQ(a.worker.memory_is_default, b.worker.memory_is_default);
  EXPECT_EQ(a.worker.scratch, b.worker.scratch);
  EXPECT_EQ(a.device.backend, b.device.backend);
  EXPECT_EQ(a.device.allowed, b.device.allowed);
  EXPECT_EQ(a.device.rank_on_host, b.device.rank_on_host);
  EXPECT_EQ(a.device.ranks_on_host, b.device.ranks_on_host);
}

TEST(WorkerSetup, ComesBackFromItsBytes) {
  expect_equal(setup_from_bytes(to_bytes(some_setup())), some_setup());
  WorkerSetup plain;
  plain.parameters.voxel_size_m = 1;
  expect_equal(setup_from_bytes(to_bytes(plain)), plain);
}

TEST(WorkerSetup, IsRefusedWhereBytesAreMissingOrLeftOver) {
  std::vector<std::uint8_t> bytes = to_bytes(some_setup());
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(setup_from_bytes(std::span(bytes).first(size)), InputError) << size;
  bytes.push_back(0);
  EXPECT_THROW(setup_from_bytes(bytes), InputError);
}

TEST(WorkerSetup, NamesABackendThatIsUnknown) {
  const auto told = [](WorkerSetup setup) {
    try {
      setup_from_bytes(to_bytes(setup));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  WorkerSetup setup = some_setup();
  setup.device.backend = Backend(77);
  EXPECT_NE(told(setup).find("holds 77, expected the number of one of auto, cpu, cuda"), std::string::npos);
}

TEST(WorkerSetup, OfRandomBytesIsAnErrorOrASetupButNeverACrash) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const std::vector<std::uint8_t> whole = to_bytes(some_setup());
  for (int round = 0; round < 20000; ++round) {
    std::vector<std::uint8_t> bytes = whole;
    for (std::uint64_t i = 1 + rng() % 8; i-- > 0;) bytes[rng() % bytes.size()] = std::uint8_t(rng());
    try {
      EXPECT_GE(setup_from_bytes(bytes).worker.threads, 1);
    } catch (const InputError&) {
      continue;
    } catch (const UsageError&) {
      continue;
    }
  }
}

}  // namespace
}  // namespace gigabake
