#include "kernels/cpu/voxelize/radix_sort.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

namespace gigabake::kernels {
namespace {

/// Bits above the range are zero, like the upper bits of brick keys.
TEST(RadixSort, IsAStableSortByTheGivenBits) {
  const std::uint64_t seed = 3;
  std::mt19937_64 rng(seed);
  for (const int threads : {1, 2, 5}) {
    const ThreadPool pool(threads);
    for (const std::size_t count : {0, 1, 2, 255, 70000})
      for (const auto& [low, high] : {std::pair{0, 64}, {32, 33}, {32, 59}, {0, 7}, {40, 40}}) {
        std::vector<std::uint64_t> values(count);
        for (auto& v : values) v = high == 64 ? rng() : rng() & ((std::uint64_t(1) << high) - 1);
        std::vector<std::uint64_t> expected = values;
        const auto key = [first = low, bits = high - low](std::uint64_t v) {
          return bits == 64 ? v : (v >> first) & ((std::uint64_t(1) << bits) - 1);
        };
        std::stable_sort(expected.begin(), expected.end(), [&](auto a, auto b) { return key(a) < key(b); });
        UnsetArray<std::uint64_t> sorted(count);
        std::copy(values.begin(), values.end(), sorted.begin());
        radix_sort(sorted, low, high, pool);
        ASSERT_EQ(std::vector(sorted.begin(), sorted.end()), expected)
            << threads << " threads, " << count << " values, bits " << low << "…" << high << ", seed " << seed;
      }
  }
}

}  // namespace
}  // namespace gigabake::kernels
