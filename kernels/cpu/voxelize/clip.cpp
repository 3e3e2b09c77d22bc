#include "kernels/cpu/voxelize/clip.h"

#include <bit>

#include "core/octree/morton.h"

namespace gigabake::kernels {
namespace {

constexpr std::size_t words_per_brick = 8;

/// Replaces the masks of all bricks by the masks of the kept voxels, and returns the old masks.
std::vector<std::uint64_t> keep_in_masks(Level& level, const KeptInBrick& kept_in, const ThreadPool& pool) {
  std::vector<std::uint64_t> before = level.mask;
  pool.parallel_for(level.key.size(), 16, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t b = begin; b < end; ++b) {
      const VoxelMask kept = kept_in(level.key[b]);
      for (std::size_t w = 0; w < words_per_brick; ++w) level.mask[words_per_brick * b + w] &= kept[w];
    }
  });
  return before;
}

/// Moves the values of kept voxels to the front of the array.
template <class Value>
void keep_values(std::vector<Value>& values, std::size_t per_voxel, std::uint64_t from, std::uint64_t to) {
  for (std::size_t c = 0; c < per_voxel; ++c) values[to * per_voxel + c] = values[from * per_voxel + c];
}

}  // namespace

void clip(Level& level, int lod, const CellParameters& parameters, const ThreadPool& pool) {
  const Vec3i64 min = parameters.window_min >> lod;
  const auto kept = [&](std::uint64_t key) {
    return parameters.kept(min + static_cast<Vec3i64>(demorton(key)) * std::int64_t(brick_edge), lod);
  };
  keep_voxels(level, kept, pool);
}

void keep_voxels(Level& level, const KeptInBrick& kept_in, const ThreadPool& pool) {
  const std::vector<std::uint64_t> before = keep_in_masks(level, kept_in, pool);
  const std::size_t per_normal = level.normal.empty() ? 0 : 2,
                    per_plane = level.directional_coverage.empty() ? 0 : directional_coverage_bytes,
                    per_class = level.voxel_class.empty() ? 0 : 1;
  std::uint64_t from = 0, to = 0;
  std::size_t bricks = 0;
  for (std::size_t b = 0; b < level.key.size(); ++b) {
    const std::uint64_t first = to;
    for (std::size_t w = 0; w < words_per_brick; ++w) {
      const std::uint64_t kept = level.mask[words_per_brick * b + w];
      for (std::uint64_t left = before[words_per_brick * b + w]; left != 0; left &= left - 1, ++from) {
        if ((kept >> std::countr_zero(left) & 1) == 0) continue;
        keep_values(level.rgba, 4, from, to);
        keep_values(level.normal, per_normal, from, to);
        keep_values(level.directional_coverage, per_plane, from, to);
        keep_values(level.voxel_class, per_class, from, to);
        ++to;
      }
      level.mask[words_per_brick * bricks + w] = kept;
    }
    if (to == first) continue;
    level.key[bricks] = level.key[b];
    level.first[bricks++] = first;
  }
  level.key.resize(bricks);
  level.mask.resize(words_per_brick * bricks);
  level.first.resize(bricks + 1);
  level.first[bricks] = to;
  level.rgba.resize(4 * to);
  level.normal.resize(per_normal * to);
  level.directional_coverage.resize(per_plane * to);
  level.voxel_class.resize(per_class * to);
}

}  // namespace gigabake::kernels
