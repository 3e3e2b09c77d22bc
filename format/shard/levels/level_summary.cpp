#include "format/shard/levels/level_summary.h"

#include <algorithm>
#include <numeric>

namespace gigabake {
namespace {

constexpr std::size_t alphas = 256, voxels_per_part = 1 << 18;

std::size_t bin_of(std::size_t alpha) { return alpha == alphas - 1 ? LevelSummary::bins - 1 : alpha / 64; }

/// Counts the alphas of voxels [begin, end). Uses two tables. Neighbours often have the same alpha, and each increment
/// of an entry waits for the previous increment.
AlphaCounts count_alphas(const BrickLevel& level, std::size_t begin, std::size_t end) {
  std::array<AlphaCounts, 2> counts{};
  for (std::size_t i = begin; i < end; ++i) ++counts[i & 1][level.rgba[4 * i + 3]];
  for (std::size_t a = 0; a < alphas; ++a) counts[0][a] += counts[1][a];
  return counts[0];
}

AlphaCounts count_alphas(const BrickLevel& level, const ThreadPool& pool) {
  std::vector<AlphaCounts> of_thread(std::size_t(pool.threads()));
  pool.parallel_for(level.rgba.size() / 4, voxels_per_part, [&](std::size_t begin, std::size_t end, int thread) {
    const AlphaCounts part = count_alphas(level, begin, end);
    for (std::size_t a = 0; a < alphas; ++a) of_thread[std::size_t(thread)][a] += part[a];
  });
  for (std::size_t t = 1; t < of_thread.size(); ++t)
    for (std::size_t a = 0; a < alphas; ++a) of_thread[0][a] += of_thread[t][a];
  return of_thread[0];
}

LevelSummary summary_of(const AlphaCounts& counts) {
  LevelSummary out;
  for (std::size_t a = 0; a < alphas; ++a) {
    out.coverage[bin_of(a)] += counts[a];
    out.alpha_sum += counts[a] * a;
  }
  return out;
}

}  // namespace

std::uint64_t LevelSummary::voxels() const {
  return std::accumulate(coverage.begin(), coverage.end(), std::uint64_t(0));
}

double LevelSummary::mean_coverage() const {
  return voxels() == 0 ? 0 : double(alpha_sum) / (255.0 * double(voxels()));
}

LevelSummary& LevelSummary::operator+=(const LevelSummary& other) {
  for (std::size_t b = 0; b < bins; ++b) coverage[b] += other.coverage[b];
  alpha_sum += other.alpha_sum;
  stored_bytes += other.stored_bytes;
  return *this;
}

std::vector<LevelSummary> summarize_levels(const Shard& shard, const ThreadPool& pool) {
  std::vector<AlphaCounts> counts;
  for (const BrickLevel& level : shard.levels) counts.push_back(count_alphas(level, pool));
  return summarize_levels(counts, shard.nodes);
}

std::vector<LevelSummary> summarize_levels(const std::vector<AlphaCounts>& counts, const NodeTable& nodes) {
  std::vector<LevelSummary> out;
  for (const AlphaCounts& level : counts) out.push_back(summary_of(level));
  for (std::size_t n = 0; n < nodes.kind.size(); ++n) {
    if (nodes.kind[n] == NodeKind::brick) continue;
    const int lod = nodes.lod[n];
    const int lowest = nodes.kind[n] == NodeKind::leaf_constant ? 0 : lod;
    const std::uint64_t alpha = nodes.value[n] >> 24;
    for (int l = lod; l >= lowest; --l) {
      const std::uint64_t voxels = std::uint64_t(brick_voxels) << 3 * (lod - l);
      out[std::size_t(l)].coverage[bin_of(alpha)] += voxels;
      out[std::size_t(l)].alpha_sum += voxels * alpha;
    }
  }
  return out;
}

void add_levels(const std::vector<LevelSummary>& of, std::size_t first_lod, std::size_t copied,
                std::vector<LevelSummary>& to) {
  to.resize(std::max(to.size(), first_lod + of.size()));
  for (std::size_t lod = copied; lod < of.size(); ++lod) to[first_lod + lod] += of[lod];
}

}  // namespace gigabake
