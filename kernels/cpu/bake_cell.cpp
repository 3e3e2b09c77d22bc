#include "kernels/cpu/bake_cell.h"

#include <algorithm>
#include <chrono>

#include "core/base/thread_pool.h"
#include "kernels/body/voxelize/window.h"
#include "kernels/cpu/mip/downsample_state.h"
#include "kernels/cpu/mip/level_hash.h"
#include "kernels/cpu/mip/levels.h"
#include "kernels/cpu/prune/prune.h"
#include "kernels/cpu/voxelize/bin.h"
#include "kernels/cpu/voxelize/clip.h"
#include "kernels/cpu/voxelize/quantize_groups.h"
#include "kernels/cpu/voxelize/voxelize.h"
#include "kernels/cpu/voxelize/window_triangles.h"

namespace gigabake::kernels {
namespace {

/// A timer that adds its lifetime in seconds to a counter.
class StageClock {
 public:
  explicit StageClock(double& seconds) : seconds_(seconds) {}
  ~StageClock() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// The estimated memory per pair in bytes. The sort needs two copies of a pair. The voxels of its brick need memory
/// until the runs are joined.
constexpr std::uint64_t bytes_per_pair = 64;
constexpr std::uint64_t min_pairs_per_batch = 1 << 16;
constexpr std::uint64_t max_pairs_per_batch = 1 << 26;

std::uint64_t pairs_per_batch(const CellParameters& parameters, std::uint64_t triangle_bytes) {
  if (parameters.memory_bytes == 0) return max_pairs_per_batch;
  const std::uint64_t left = parameters.memory_bytes > triangle_bytes ? parameters.memory_bytes - triangle_bytes : 0;
  return std::clamp(left / bytes_per_pair, min_pairs_per_batch, max_pairs_per_batch);
}

std::uint64_t bytes_of(const Level& l) {
  return 8 * (l.key.capacity() + l.mask.capacity() + l.first.capacity()) + l.rgba.capacity() + l.normal.capacity() +
         l.directional_coverage.capacity();
}

std::uint64_t bytes_of(const std::vector<Level>& levels) {
  std::uint64_t bytes = 0;
  for (const Level& l : levels) bytes += bytes_of(l);
  return bytes;
}

Level finest_level(const CellInput& input, const CellParameters& parameters, const ThreadPool& pool, CellStats& stats) {
  UnsetArray<WindowTriangle> triangles;
  {
    const StageClock clock(stats.snap_s);
    triangles = window_triangles(input, parameters, pool, stats);
  }
  const std::uint64_t triangle_bytes = triangles.size() * sizeof(WindowTriangle);
  std::vector<Batch> batches;
  {
    const StageClock clock(stats.bin_s);
    batches = plan_batches(triangles, parameters, pairs_per_batch(parameters, triangle_bytes), pool);
  }
  Level level;
  for (const Batch& batch : batches) {
    UnsetArray<Pair> pairs;
    {
      const StageClock clock(stats.sort_s);
      pairs = sorted_pairs(triangles, parameters, batch, pool, stats);
    }
    const StageClock clock(stats.voxelize_s);
    voxelize(input, triangles, parameters, pairs, pool, level, stats);
    stats.peak_bytes =
        std::max(stats.peak_bytes, triangle_bytes + pairs.size() * 2 * sizeof(Pair) + 2 * bytes_of(level));
  }
  stats.batches = batches.size();
  return level;
}

/// Stores the finest level in the volume, and computes everything else from this level.
void add_all_but_finest(Level finest, const CellParameters& parameters, const ThreadPool& pool, CellVolume& volume) {
  if (finest.key.empty()) return;
  volume.levels.push_back(std::move(finest));
  const int lods = window_of(parameters).levels + 1;
  {
    const StageClock clock(volume.stats.mip_s);
    LevelSurface surface;
    add_coarser_levels(volume.levels, surface, lods, parameters.mip, parameters.normals, pool);
    volume.above = downsample_state(volume.levels, lods - 1, surface, parameters.mip);
    if (!parameters.directional_coverage) drop_directional_coverage(volume.levels);
  }
  volume.stats.peak_bytes = std::max(volume.stats.peak_bytes, 2 * bytes_of(volume.levels));
  {
    const StageClock clock(volume.stats.prune_s);
    quantize_groups(volume.levels, parameters.max_error, pool);
  }
  {
    const StageClock clock(volume.stats.hash_s);
    volume.content_hash = level_hashes(volume.levels, parameters.window_min, pool);
  }
  const StageClock clock(volume.stats.prune_s);
  volume.nodes = prune(volume.levels, pool);
}

}  // namespace

CellVolume bake_cell(const CellInput& input, const CellParameters& parameters, const ThreadPool& pool) {
  CellVolume volume;
  Level finest = finest_level(input, parameters, pool, volume.stats);
  if (parameters.edits != nullptr)
    parameters.edits->apply(finest, 0, std::uint64_t(1) << key_bits(window_of(parameters)));
  if (parameters.kept) clip(finest, parameters, pool);
  add_all_but_finest(std::move(finest), parameters, pool, volume);
  return volume;
}

CellVolume volume_of(Level finest, const CellParameters& parameters, const ThreadPool& pool) {
  CellVolume volume;
  add_all_but_finest(std::move(finest), parameters, pool, volume);
  return volume;
}

}  // namespace gigabake::kernels
