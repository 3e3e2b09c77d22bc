#include "kernels/cpu/brick_run.h"

#include <algorithm>
#include <bit>

#include "lattice/thread_pool.h"

namespace gigabake::kernels {
namespace {

/// Where a run lands in the level.
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

}  // namespace

void append(Level& level, std::vector<BrickRun>& runs, const ThreadPool& pool) {
  if (level.first.empty()) level.first.push_back(0);
  const std::vector<Landing> at = landings(runs, {level.key.size(), level.rgba.size() / 4});
  level.key.resize(at.back().brick);
  level.mask.resize(8 * at.back().brick);
  level.first.resize(at.back().brick + 1);
  level.rgba.resize(4 * at.back().voxel);
  if (!runs.empty() && runs.front().normals_) level.normal.resize(2 * at.back().voxel);
  if (!runs.empty() && !runs.front().facing_.empty()) level.facing.resize(facing_bytes * at.back().voxel);
  pool.parallel_for(runs.size(), 4, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t r = begin; r < end; ++r) {
      BrickRun& run = runs[r];
      std::copy(run.key_.begin(), run.key_.end(), level.key.begin() + at[r].brick);
      std::copy(run.mask_.begin(), run.mask_.end(), level.mask.begin() + 8 * at[r].brick);
      std::copy(run.rgba_.begin(), run.rgba_.end(), level.rgba.begin() + 4 * at[r].voxel);
      std::copy(run.normal_.begin(), run.normal_.end(), level.normal.begin() + 2 * at[r].voxel);
      std::copy(run.facing_.begin(), run.facing_.end(), level.facing.begin() + facing_bytes * at[r].voxel);
      std::uint64_t first = at[r].voxel;
      for (std::size_t b = 0; b < run.bricks(); ++b) {
        for (int word = 0; word < 8; ++word) first += std::popcount(run.mask_[8 * b + word]);
        level.first[at[r].brick + b + 1] = first;
      }
      run = BrickRun(run.normals_);
    }
  });
}

}  // namespace gigabake::kernels
