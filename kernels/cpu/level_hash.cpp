#include "kernels/cpu/level_hash.h"

#include <bit>
#include <cstring>

#include "lattice/brick.h"
#include "lattice/morton.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {
namespace {

constexpr std::size_t bricks_per_range = 1024;

Hash128 brick_hash(const Level& level, std::size_t brick, int lod, const std::int64_t window_min[3]) {
  const BrickCoordinate at = demorton(level.key[brick]);
  const std::int64_t corner[3] = {window_min[0] + (std::int64_t(at.x) << (lod + 3)),
                                  window_min[1] + (std::int64_t(at.y) << (lod + 3)),
                                  window_min[2] + (std::int64_t(at.z) << (lod + 3))};
  Hash128 sum;
  std::size_t i = level.first[brick];
  for (int z = 0; z < brick_edge; ++z)
    for (std::uint64_t rest = level.mask[8 * brick + std::size_t(z)]; rest != 0; rest &= rest - 1, ++i) {
      const int bit = std::countr_zero(rest);
      std::uint32_t rgba;
      std::uint16_t normal = 0;
      std::memcpy(&rgba, &level.rgba[4 * i], 4);
      if (!level.normal.empty()) std::memcpy(&normal, &level.normal[2 * i], 2);
      const std::int64_t at_x = corner[0] + (std::int64_t(bit & 7) << lod),
                         at_y = corner[1] + (std::int64_t(bit >> 3) << lod),
                         at_z = corner[2] + (std::int64_t(z) << lod);
      if (level.facing.empty()) {
        sum += hash_voxel(lod, at_x, at_y, at_z, rgba, normal);
      } else {
        const std::uint8_t* f = &level.facing[3 * i];
        sum += hash_voxel(lod, at_x, at_y, at_z, rgba, normal, f[0] | f[1] << 8 | f[2] << 16);
      }
    }
  return sum;
}

}  // namespace

Hash128 level_hash(const Level& level, int lod, const std::int64_t window_min[3], const ThreadPool& pool) {
  std::vector<Hash128> of_thread(std::size_t(pool.threads()));
  pool.parallel_for(level.key.size(), bricks_per_range, [&](std::size_t begin, std::size_t end, int thread) {
    Hash128 sum;
    for (std::size_t b = begin; b < end; ++b) sum += brick_hash(level, b, lod, window_min);
    of_thread[std::size_t(thread)] += sum;
  });
  Hash128 all;
  for (const Hash128& sum : of_thread) all += sum;
  return all;
}

std::vector<Hash128> level_hashes(const std::vector<Level>& levels, const std::int64_t window_min[3],
                                  const ThreadPool& pool) {
  std::vector<Hash128> hashes;
  for (std::size_t lod = 0; lod < levels.size(); ++lod)
    hashes.push_back(level_hash(levels[lod], int(lod), window_min, pool));
  return hashes;
}

}  // namespace gigabake::kernels
