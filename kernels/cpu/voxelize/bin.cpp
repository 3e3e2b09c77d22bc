#include "kernels/cpu/voxelize/bin.h"

#include <algorithm>
#include <utility>

#include "core/base/thread_pool.h"
#include "kernels/body/voxelize/triangle_bricks.h"
#include "kernels/body/voxelize/window.h"
#include "kernels/cpu/voxelize/radix_sort.h"
#include "kernels/cpu/voxelize/stored_depth.h"

namespace gigabake::kernels {
namespace {

constexpr std::size_t triangles_per_range = 8192;
constexpr int bucket_bits = 15;

std::size_t range_count(std::size_t triangles) { return (triangles + triangles_per_range - 1) / triangles_per_range; }

/// The triangles of a level, and the bricks in which they are voxelized.
struct PairSource {
  std::span<const WindowTriangle> triangles;
  CellWindow window;
  BrickChoice choice;

  /// Calls visit(key, triangle) for all pairs of one range of triangles.
  template <class Visit>
  void visit_range(std::size_t range, const Visit& visit) const {
    const std::size_t end = std::min(triangles.size(), (range + 1) * triangles_per_range);
    for (std::size_t t = range * triangles_per_range; t < end; ++t) {
      const auto visit_key = [&](std::uint64_t key) { visit(key, std::uint32_t(t)); };
      if (choice.depth == nullptr)
        for_each_brick(triangles[t], window, visit_key);
      else
        choice.depth->for_each_brick(triangles[t], choice.lod, visit_key);
    }
  }
};

/// Numbers of pairs.
struct PairCounts {
  std::vector<std::uint64_t> bucket, range;
};

PairCounts count_pairs(const PairSource& source, int bucket_shift, const ThreadPool& pool) {
  const std::size_t buckets = std::size_t(1) << (key_bits(source.window) - bucket_shift);
  std::vector<std::vector<std::uint64_t>> counts(pool.threads(), std::vector<std::uint64_t>(buckets, 0));
  std::vector<std::uint64_t> of_range(range_count(source.triangles.size()));
  pool.parallel_for(of_range.size(), 1, [&](std::size_t begin, std::size_t end, int thread) {
    for (std::size_t r = begin; r < end; ++r) {
      std::uint64_t n = 0;
      source.visit_range(r, [&](std::uint64_t key, std::uint32_t) {
        ++counts[thread][key >> bucket_shift];
        ++n;
      });
      of_range[r] = n;
    }
  });
  for (std::size_t i = 1; i < counts.size(); ++i)
    for (std::size_t b = 0; b < buckets; ++b) counts[0][b] += counts[i][b];
  return {std::move(counts[0]), std::move(of_range)};
}

/// Counts the batch's pairs of each range of triangles.
template <class InBatch>
std::vector<std::uint64_t> count_in_batch(const PairSource& source, const InBatch& in_batch, const ThreadPool& pool) {
  std::vector<std::uint64_t> counts(range_count(source.triangles.size()));
  pool.parallel_for(counts.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t r = begin; r < end; ++r) {
      std::uint64_t n = 0;
      source.visit_range(r, [&](std::uint64_t key, std::uint32_t) { n += in_batch(key); });
      counts[r] = n;
    }
  });
  return counts;
}

}  // namespace

std::vector<Batch> plan_batches(std::span<const WindowTriangle> triangles, const CellParameters& parameters,
                                std::uint64_t pairs_per_batch, const ThreadPool& pool, const BrickChoice& choice) {
  const PairSource source{triangles, window_of(parameters), choice};
  const int shift = std::max(0, key_bits(source.window) - bucket_bits);
  PairCounts counts = count_pairs(source, shift, pool);
  std::vector<Batch> batches;
  Batch open{0, 0, 0};
  const auto close = [&] {
    if (open.pairs != 0) batches.push_back(open);
  };
  for (std::uint64_t b = 0; b < counts.bucket.size(); ++b) {
    if (open.pairs != 0 && open.pairs + counts.bucket[b] > pairs_per_batch) {
      close();
      open = {b << shift, 0, 0};
    }
    open.end_key = (b + 1) << shift;
    open.pairs += counts.bucket[b];
  }
  close();
  if (batches.size() == 1) batches.front().range_pairs = std::move(counts.range);
  return batches;
}

UnsetArray<Pair> sorted_pairs(std::span<const WindowTriangle> triangles, const CellParameters& parameters,
                              const Batch& batch, const ThreadPool& pool, CellStats& stats, const BrickChoice& choice) {
  const PairSource source{triangles, window_of(parameters), choice};
  const auto in_batch = [&](std::uint64_t key) { return key >= batch.first_key && key < batch.end_key; };
  const std::vector<std::uint64_t> counts =
      batch.range_pairs.empty() ? count_in_batch(source, in_batch, pool) : batch.range_pairs;
  std::vector<std::uint64_t> first{0};
  for (const std::uint64_t n : counts) first.push_back(first.back() + n);
  UnsetArray<Pair> pairs(first.back());
  pool.parallel_for(first.size() - 1, 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t r = begin; r < end; ++r) {
      std::uint64_t at = first[r];
      source.visit_range(r, [&](std::uint64_t key, std::uint32_t t) {
        if (in_batch(key)) pairs[at++] = make_pair(key, t);
      });
    }
  });
  stats.pairs += pairs.size();
  radix_sort(pairs, 32, 32 + key_bits(source.window), pool);
  return pairs;
}

}  // namespace gigabake::kernels
