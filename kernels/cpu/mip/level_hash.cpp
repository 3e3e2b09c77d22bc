#include "kernels/cpu/mip/level_hash.h"

#include <bit>

#include "core/base/thread_pool.h"
#include "core/octree/brick.h"
#include "core/octree/morton.h"
#include "kernels/body/mip/level_voxel.h"

namespace gigabake::kernels {
namespace {

constexpr std::size_t bricks_per_hash_range = 1024;

Hash128 brick_hash(const Level& level, std::size_t brick, int lod, const Vec3i64& window_min) {
  const BrickCoordinate at = demorton(level.key[brick]);
  Hash128 sum;
  std::size_t i = level.first[brick];
  const auto coverage = [&] {
    return level.directional_coverage.empty() ? nullptr : &level.directional_coverage[directional_coverage_bytes * i];
  };
  const auto normal = [&] { return level.normal.empty() ? std::uint16_t(0) : pack_normal(&level.normal[2 * i]); };
  for (int z = 0; z < brick_edge; ++z)
    for (std::uint64_t rest = level.mask[8 * brick + std::size_t(z)]; rest != 0; rest &= rest - 1, ++i)
      sum += level.voxel_class.empty()
                 ? hash_of_voxel(window_min, lod, at, 64 * z + std::countr_zero(rest), pack_rgba(&level.rgba[4 * i]),
                                 normal(), coverage())
                 : hash_of_voxel(window_min, lod, at, 64 * z + std::countr_zero(rest), pack_rgba(&level.rgba[4 * i]),
                                 normal(), coverage(), level.voxel_class[i]);
  return sum;
}

}  // namespace

Hash128 level_hash(const Level& level, int lod, const Vec3i64& window_min, const ThreadPool& pool) {
  std::vector<Hash128> of_thread(std::size_t(pool.threads()));
  pool.parallel_for(level.key.size(), bricks_per_hash_range, [&](std::size_t begin, std::size_t end, int thread) {
    Hash128 sum;
    for (std::size_t b = begin; b < end; ++b) sum += brick_hash(level, b, lod, window_min);
    of_thread[std::size_t(thread)] += sum;
  });
  Hash128 all;
  for (const Hash128& sum : of_thread) all += sum;
  return all;
}

std::vector<Hash128> level_hashes(const std::vector<Level>& levels, const Vec3i64& window_min, const ThreadPool& pool) {
  std::vector<Hash128> hashes;
  for (std::size_t lod = 0; lod < levels.size(); ++lod)
    hashes.push_back(level_hash(levels[lod], int(lod), window_min, pool));
  return hashes;
}

}  // namespace gigabake::kernels
