#include "kernels/light/stored_voxel.h"

#include <algorithm>

namespace gigabake::kernels {
namespace {

using BrickPages = std::array<StoredVoxels, max_brick_pages>;

void write_runs(const StoredVoxelShading& shading, const BrickPages& pages, const CastBrick& brick,
                PackedVoxel* parts) {
  for (const VoxelRun& run : brick.runs)
    write_run(shading, brick.lod, pages[run.page], run, {brick.head.layers, 0, parts}, parts);
}

}  // namespace

void copy_runs(const StoredVoxelShading& shading, const BrickPages& pages, CastBrick& brick) {
  brick.parts.resize(brick.part_count);
  write_runs(shading, pages, brick, brick.parts.data());
  brick.runs.clear();
}

void copy_pooled_runs(const StoredVoxelShading& shading, const StoredVoxels& pool, const CastBrick& brick,
                      PackedVoxel* parts) {
  if (brick.runs.empty()) return;
  BrickPages pages;
  std::ranges::transform(brick.pages, pages.begin(), [&](const PooledPage& page) { return voxels_of(pool, page); });
  write_runs(shading, pages, brick, parts);
}

}  // namespace gigabake::kernels
