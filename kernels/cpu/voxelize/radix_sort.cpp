#include "kernels/cpu/voxelize/radix_sort.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/base/thread_pool.h"

namespace gigabake::kernels {
namespace {

constexpr int digit_bits = 8, digits = 1 << digit_bits;
using Histogram = std::array<std::size_t, digits>;

struct Slices {
  std::size_t count, per_slice;
  std::size_t begin(std::size_t s) const { return s * per_slice; }
  std::size_t end(std::size_t s, std::size_t size) const { return std::min(size, (s + 1) * per_slice); }
};

void scatter_by_digit(const UnsetArray<std::uint64_t>& from, UnsetArray<std::uint64_t>& to, int bit,
                      const Slices& slices, const ThreadPool& pool) {
  std::vector<Histogram> offsets(slices.count);
  const auto digit = [bit](std::uint64_t v) { return v >> bit & (digits - 1); };
  pool.parallel_for(slices.count, 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t s = begin; s < end; ++s) {
      offsets[s].fill(0);
      for (std::size_t i = slices.begin(s); i < slices.end(s, from.size()); ++i) ++offsets[s][digit(from[i])];
    }
  });
  std::size_t running = 0;
  for (int d = 0; d < digits; ++d)
    for (Histogram& h : offsets) {
      const std::size_t n = h[d];
      h[d] = running;
      running += n;
    }
  pool.parallel_for(slices.count, 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t s = begin; s < end; ++s)
      for (std::size_t i = slices.begin(s); i < slices.end(s, from.size()); ++i)
        to[offsets[s][digit(from[i])]++] = from[i];
  });
}

}  // namespace

void radix_sort(UnsetArray<std::uint64_t>& values, int low_bit, int high_bit, const ThreadPool& pool) {
  if (values.size() < 2) return;
  const std::size_t wanted = std::min<std::size_t>(pool.threads(), (values.size() + 4095) / 4096);
  const Slices slices{wanted, (values.size() + wanted - 1) / wanted};
  UnsetArray<std::uint64_t> other(values.size());
  for (int bit = low_bit; bit < high_bit; bit += digit_bits) {
    scatter_by_digit(values, other, bit, slices, pool);
    std::swap(values, other);
  }
}

}  // namespace gigabake::kernels
