#include "kernels/cpu/bake_cell.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <span>

#include "core/base/thread_pool.h"
#include "kernels/body/voxelize/window.h"
#include "kernels/cpu/mip/downsample_state.h"
#include "kernels/cpu/mip/end_branches.h"
#include "kernels/cpu/mip/level_hash.h"
#include "kernels/cpu/mip/levels.h"
#include "kernels/cpu/prune/prune.h"
#include "kernels/cpu/voxelize/bin.h"
#include "kernels/cpu/voxelize/clip.h"
#include "kernels/cpu/voxelize/quantize_groups.h"
#include "kernels/cpu/voxelize/stored_depth.h"
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
         l.directional_coverage.capacity() + sizeof(VoxelClass) * l.voxel_class.capacity();
}

std::uint64_t bytes_of(const std::vector<Level>& levels) {
  std::uint64_t bytes = 0;
  for (const Level& l : levels) bytes += bytes_of(l);
  return bytes;
}

/// The triangles of a level, and the bricks in which they are voxelized.
struct LevelInput {
  std::span<const WindowTriangle> triangles;
  BrickChoice choice;
};

/// Voxelizes triangles in batches of bricks. `parameters` belong to the level; `base_bytes` is the memory of all
/// triangles.
Level voxelized_level(const CellInput& input, const LevelInput& from, const CellParameters& parameters,
                      std::uint64_t base_bytes, const ThreadPool& pool, CellStats& stats) {
  std::vector<Batch> batches;
  {
    const StageClock clock(stats.bin_s);
    batches = plan_batches(from.triangles, parameters, pairs_per_batch(parameters, base_bytes), pool, from.choice);
  }
  Level level;
  for (const Batch& batch : batches) {
    UnsetArray<Pair> pairs;
    {
      const StageClock clock(stats.sort_s);
      pairs = sorted_pairs(from.triangles, parameters, batch, pool, stats, from.choice);
    }
    const StageClock clock(stats.voxelize_s);
    voxelize(input, from.triangles, parameters, pairs, pool, level, stats);
    stats.peak_bytes = std::max(stats.peak_bytes, base_bytes + pairs.size() * 2 * sizeof(Pair) + 2 * bytes_of(level));
  }
  stats.batches += batches.size();
  return level;
}

/// Voxelizes parts of several levels: lod 0, then the leaves of each level.
std::vector<Level> voxelized_levels(const CellInput& input, std::span<const WindowTriangle> triangles,
                                    const CellParameters& parameters, const ThreadPool& pool, CellStats& stats) {
  std::optional<StoredDepth> depth;
  {
    const StageClock clock(stats.bin_s);
    depth.emplace(input, triangles, parameters, pool);
  }
  const std::uint64_t base_bytes = triangles.size() * sizeof(WindowTriangle) + depth->bytes();
  std::vector<Level> levels;
  for (int lod = 0; lod <= depth->coarsest(); ++lod) {
    levels.push_back(voxelized_level(input, {depth->triangles(lod), {&*depth, lod}}, at_level(parameters, lod),
                                     base_bytes, pool, stats));
    if (lod > 0)
      keep_voxels(
          levels.back(), [&](std::uint64_t key) { return depth->own_voxels(key, lod); }, pool);
  }
  return levels;
}

/// Returns the voxels of lod 0, then the leaves of each level; only lod 0 if all parts are voxelized there.
std::vector<Level> voxelized(const CellInput& input, const CellParameters& parameters, const ThreadPool& pool,
                             CellStats& stats) {
  UnsetArray<WindowTriangle> triangles;
  {
    const StageClock clock(stats.snap_s);
    triangles = window_triangles(input, parameters, pool, stats);
  }
  if (coarsest_lod(input) > 0) return voxelized_levels(input, triangles, parameters, pool, stats);
  std::vector<Level> finest;
  finest.push_back(
      voxelized_level(input, {triangles, {}}, parameters, triangles.size() * sizeof(WindowTriangle), pool, stats));
  return finest;
}

/// Stores the finest level in the volume, and computes everything else from this level and the leaves.
void add_levels(std::vector<Level> voxelized, const CellParameters& parameters, const ThreadPool& pool,
                CellVolume& volume) {
  if (std::ranges::all_of(voxelized, [](const Level& level) { return level.key.empty(); })) return;
  volume.levels.push_back(std::move(voxelized.front()));
  if (volume.levels.front().first.empty()) volume.levels.front().first.push_back(0);
  const int lods = window_of(parameters).levels + 1;
  {
    const StageClock clock(volume.stats.mip_s);
    LevelSurface surface;
    add_coarser_levels(volume.levels, surface, lods, parameters.mip, parameters.normals, pool, voxelized);
    volume.above = downsample_state(volume.levels, lods - 1, surface, parameters.mip);
    if (!parameters.directional_coverage) drop_directional_coverage(volume.levels);
  }
  volume.stats.peak_bytes = std::max(volume.stats.peak_bytes, 2 * bytes_of(volume.levels));
  {
    const StageClock clock(volume.stats.prune_s);
    end_branches(volume.levels, parameters.depth_error, pool);
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
  std::vector<Level> levels = voxelized(input, parameters, pool, volume.stats);
  if (parameters.edits != nullptr)
    parameters.edits->apply(levels.front(), 0, std::uint64_t(1) << key_bits(window_of(parameters)));
  for (std::size_t lod = 0; parameters.kept && lod < levels.size(); ++lod)
    clip(levels[lod], int(lod), parameters, pool);
  add_levels(std::move(levels), parameters, pool, volume);
  return volume;
}

CellVolume volume_of(std::vector<Level> voxelized, const CellParameters& parameters, const ThreadPool& pool) {
  CellVolume volume;
  add_levels(std::move(voxelized), parameters, pool, volume);
  return volume;
}

}  // namespace gigabake::kernels
