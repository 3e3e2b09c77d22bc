#include "kernels/cpu/mip/two_level_filter.h"

#include <array>
#include <bit>
#include <memory>
#include <vector>

#include "core/octree/brick.h"
#include "kernels/body/mip/two_level_filter.h"
#include "kernels/cpu/mip/level_read.h"
#include "kernels/cpu/voxelize/brick_run.h"

namespace gigabake::kernels {
namespace {

/// A brick under construction.
struct CoarseBrick {
  std::uint64_t mask[8] = {};
  Voxel voxel[brick_voxels];  ///< index x + 8y + 64z; entries without a mask bit are stale
};

void fill_from(const Level& fine, std::size_t brick, const Tables& tables, CoarseBrick& out) {
  const std::uint64_t* mask = &fine.mask[8 * brick];
  for (int octant = 0; octant < 8; ++octant) {
    if (!has_voxels(mask, octant)) continue;
    const int to = grandparent_voxel(fine.key[brick], octant);
    out.mask[to >> 6] |= std::uint64_t(1) << (to & 63);
    out.voxel[to] = two_level_filter(
        mask, octant, fine.first[brick], [&](std::size_t i) { return voxel_at(fine, i); }, tables);
  }
}

void pack(const CoarseBrick& brick, std::uint64_t key, BrickRun& run) {
  std::array<Voxel, brick_voxels> voxels;
  std::size_t count = 0;
  for (int word = 0; word < 8; ++word)
    for (std::uint64_t rest = brick.mask[word]; rest != 0; rest &= rest - 1)
      voxels[count++] = brick.voxel[64 * word + std::countr_zero(rest)];
  run.push_brick(key, brick.mask, std::span(voxels).first(count));
}

}  // namespace

Level two_level_filtered_level(const Level& fine, bool normals, const ThreadPool& pool) {
  const Tables tables = TableStore::host().view();
  const std::vector<std::size_t> starts = starts_below(fine, grandparent_key);
  const std::size_t bricks = starts.size() - 1;
  std::vector<BrickRun> runs((bricks + bricks_per_run - 1) / bricks_per_run, BrickRun(normals));
  pool.parallel_for(bricks, bricks_per_run, [&](std::size_t begin, std::size_t end, int) {
    const auto brick = std::make_unique<CoarseBrick>();
    for (std::size_t b = begin; b < end; ++b) {
      for (std::uint64_t& word : brick->mask) word = 0;
      for (std::size_t child = starts[b]; child < starts[b + 1]; ++child) fill_from(fine, child, tables, *brick);
      pack(*brick, grandparent_key(fine.key[starts[b]]), runs[b / bricks_per_run]);
    }
  });
  Level out;
  append(out, runs, pool);
  return out;
}

}  // namespace gigabake::kernels
