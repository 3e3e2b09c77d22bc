#include "kernels/cpu/voxelize/brick_run.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/base/thread_pool.h"

namespace gigabake::kernels {
namespace {

/// The indices of a run's first brick and first voxel in the level.
struct Landing {
  std::size_t brick, voxel;
};

std::vector<Landing> landings(const std::vector<BrickRun>& runs, Landing at) {
  std::vector<Landing> result;
  for (const BrickRun& run : runs) {
    result.push_back(at);
    at.brick += run.bricks();
    at.voxel += run.voxels();
  }
  result.push_back(at);
  return result;
}

/// Returns the threads that grow the arrays of a level of `voxels` voxels: only the caller's if this takes less time
/// than joining threads.
const ThreadPool& threads_for(std::size_t voxels, const ThreadPool& pool) {
  constexpr std::size_t min_voxels_to_share = std::size_t(1) << 15;
  return voxels < min_voxels_to_share ? callers_thread() : pool;
}

}  // namespace

/// Reserves memory for a whole run whose bricks have as many voxels as the first. Growing the arrays brick by brick
/// copies them several times.
void BrickRun::reserve_for(std::size_t voxels_per_brick) {
  const std::size_t voxels = bricks_per_run * voxels_per_brick;
  key_.reserve(bricks_per_run);
  mask_.reserve(8 * bricks_per_run);
  rgba_.reserve(4 * voxels);
  if (normals_) normal_.reserve(2 * voxels);
}

void BrickRun::push_brick(std::uint64_t key, const std::uint64_t mask[8], std::span<const Voxel> voxels) {
  if (key_.empty()) reserve_for(voxels.size());
  key_.push_back(key);
  mask_.insert(mask_.end(), mask, mask + 8);
  const std::size_t at = rgba_.size() / 4;
  rgba_.resize(4 * (at + voxels.size()));
  if (normals_) normal_.resize(2 * (at + voxels.size()));
  std::uint8_t* rgba = rgba_.data() + 4 * at;
  for (std::size_t i = 0; i < voxels.size(); ++i) std::memcpy(rgba + 4 * i, voxels[i].rgba, 4);
  if (!normals_) return;
  std::int8_t* normal = normal_.data() + 2 * at;
  for (std::size_t i = 0; i < voxels.size(); ++i) std::memcpy(normal + 2 * i, voxels[i].normal, 2);
}

void BrickRun::make_room(Level& level, std::size_t bricks, std::size_t voxels, bool directional_coverage, bool classes,
                         const ThreadPool& pool) const {
  // Growing an array fills it with zeros, which takes time. Each array is therefore a separate task. The largest array
  // is the first.
  threads_for(voxels, pool).parallel_for(7, 1, [&](std::size_t array, std::size_t, int) {
    if (array == 0) level.rgba.resize(4 * voxels);
    if (array == 1 && directional_coverage) level.directional_coverage.resize(directional_coverage_bytes * voxels);
    if (array == 2 && normals_) level.normal.resize(2 * voxels);
    if (array == 3) level.mask.resize(8 * bricks);
    if (array == 4) level.first.resize(bricks + 1);
    if (array == 5) level.key.resize(bricks);
    if (array == 6 && classes) level.voxel_class.resize(voxels);
  });
}

void append(Level& level, std::vector<BrickRun>& runs, const ThreadPool& pool) {
  if (level.first.empty()) level.first.push_back(0);
  const std::vector<Landing> at = landings(runs, {level.key.size(), level.rgba.size() / 4});
  const bool directional_coverage =  // the first runs may have no brick
      std::ranges::any_of(runs, [](const BrickRun& run) { return !run.directional_coverage_.empty(); });
  const bool classes = std::ranges::any_of(runs, [](const BrickRun& run) { return !run.voxel_class_.empty(); });
  if (!runs.empty())
    runs.front().make_room(level, at.back().brick, at.back().voxel, directional_coverage, classes, pool);
  pool.parallel_for(runs.size(), 4, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t r = begin; r < end; ++r) {
      BrickRun& run = runs[r];
      std::copy(run.key_.begin(), run.key_.end(), level.key.begin() + at[r].brick);
      std::copy(run.mask_.begin(), run.mask_.end(), level.mask.begin() + 8 * at[r].brick);
      std::copy(run.rgba_.begin(), run.rgba_.end(), level.rgba.begin() + 4 * at[r].voxel);
      std::copy(run.normal_.begin(), run.normal_.end(), level.normal.begin() + 2 * at[r].voxel);
      std::copy(run.directional_coverage_.begin(), run.directional_coverage_.end(),
                level.directional_coverage.begin() + directional_coverage_bytes * at[r].voxel);
      std::copy(run.voxel_class_.begin(), run.voxel_class_.end(),
                level.voxel_class.begin() + std::ptrdiff_t(at[r].voxel));
      std::uint64_t first = at[r].voxel;
      for (std::size_t b = 0; b < run.bricks(); ++b) {
        for (int word = 0; word < 8; ++word) first += std::popcount(run.mask_[8 * b + word]);
        level.first[at[r].brick + b + 1] = first;
      }
      run = BrickRun(run.normals_, run.planes_);
    }
  });
}

}  // namespace gigabake::kernels
