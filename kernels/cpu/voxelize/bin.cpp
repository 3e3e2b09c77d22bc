#include "kernels/cpu/voxelize/bin.h"

#include <algorithm>

#include "core/base/thread_pool.h"
#include "kernels/body/voxelize/triangle_bricks.h"
#include "kernels/body/voxelize/window.h"
#include "kernels/cpu/voxelize/radix_sort.h"

namespace gigabake::kernels {
namespace {

constexpr std::size_t triangles_per_range = 8192;
constexpr int bucket_bits = 15;

std::size_t range_count(std::size_t triangles) { return (triangles + triangles_per_range - 1) / triangles_per_range; }

/// Calls visit(key, triangle) for all pairs of one range of triangles.
template <class Visit>
void visit_range(std::span<const WindowTriangle> triangles, std::size_t range, const CellWindow& window,
                 const Visit& visit) {
  const std::size_t end = std::min(triangles.size(), (range + 1) * triangles_per_range);
  for (std::size_t t = range * triangles_per_range; t < end; ++t)
    for_each_brick(triangles[t], window, [&](std::uint64_t key) { visit(key, std::uint32_t(t)); });
}

std::vector<std::uint64_t> pairs_per_bucket(std::span<const WindowTriangle> triangles, const CellWindow& window,
                                            int bucket_shift, const ThreadPool& pool) {
  const std::size_t buckets = std::size_t(1) << (key_bits(window) - bucket_shift);
  std::vector<std::vector<std::uint64_t>> counts(pool.threads(), std::vector<std::uint64_t>(buckets, 0));
  pool.parallel_for(range_count(triangles.size()), 1, [&](std::size_t begin, std::size_t end, int thread) {
    for (std::size_t r = begin; r < end; ++r)
      visit_range(triangles, r, window,
                  [&](std::uint64_t key, std::uint32_t) { ++counts[thread][key >> bucket_shift]; });
  });
  for (std::size_t i = 1; i < counts.size(); ++i)
    for (std::size_t b = 0; b < buckets; ++b) counts[0][b] += counts[i][b];
  return std::move(counts[0]);
}

}  // namespace

std::vector<Batch> plan_batches(std::span<const WindowTriangle> triangles, const CellParameters& parameters,
                                std::uint64_t pairs_per_batch, const ThreadPool& pool) {
  const CellWindow window = window_of(parameters);
  const int shift = std::max(0, key_bits(window) - bucket_bits);
  const auto counts = pairs_per_bucket(triangles, window, shift, pool);
  std::vector<Batch> batches;
  Batch open{0, 0, 0};
  const auto close = [&] {
    if (open.pairs != 0) batches.push_back(open);
  };
  for (std::uint64_t b = 0; b < counts.size(); ++b) {
    if (open.pairs != 0 && open.pairs + counts[b] > pairs_per_batch) {
      close();
      open = {b << shift, 0, 0};
    }
    open.end_key = (b + 1) << shift;
    open.pairs += counts[b];
  }
  close();
  return batches;
}

UnsetArray<Pair> sorted_pairs(std::span<const WindowTriangle> triangles, const CellParameters& parameters,
                              const Batch& batch, const ThreadPool& pool, CellStats& stats) {
  const CellWindow window = window_of(parameters);
  const auto in_batch = [&](std::uint64_t key) { return key >= batch.first_key && key < batch.end_key; };
  std::vector<std::uint64_t> first(range_count(triangles.size()) + 1, 0);
  pool.parallel_for(first.size() - 1, 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t r = begin; r < end; ++r) {
      std::uint64_t n = 0;
      visit_range(triangles, r, window, [&](std::uint64_t key, std::uint32_t) { n += in_batch(key); });
      first[r + 1] = n;
    }
  });
  for (std::size_t r = 1; r < first.size(); ++r) first[r] += first[r - 1];
  UnsetArray<Pair> pairs(first.back());
  pool.parallel_for(first.size() - 1, 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t r = begin; r < end; ++r) {
      std::uint64_t at = first[r];
      visit_range(triangles, r, window, [&](std::uint64_t key, std::uint32_t t) {
        if (in_batch(key)) pairs[at++] = make_pair(key, t);
      });
    }
  });
  stats.pairs += pairs.size();
  radix_sort(pairs, 32, 32 + key_bits(window), pool);
  return pairs;
}

}  // namespace gigabake::kernels
