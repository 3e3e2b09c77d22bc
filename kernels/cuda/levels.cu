#include <algorithm>

#include "kernels/cuda/filter_high.cuh"
#include "kernels/cuda/filter_low.cuh"
#include "kernels/cuda/levels.cuh"
#include "lattice/rules.h"

namespace gigabake::kernels {
namespace {

VoxelsOut make_room(DeviceHeap& heap, MipFilter filter, bool normals, DeviceLevel& level) {
  level.rgba = DeviceArray<std::uint32_t>(heap, level.voxels);
  if (normals) level.normal = DeviceArray<std::uint16_t>(heap, level.voxels);
  if (filters_by_view(filter)) level.facing = DeviceArray<std::uint8_t>(heap, 3 * std::size_t(level.voxels));
  return {level.rgba.data(), level.normal.data(), level.facing.data()};
}

DeviceArray<std::uint32_t> room_for_rasters(DeviceHeap& heap, MipFilter filter, int lod, std::uint32_t voxels) {
  if (!filters_by_view(filter)) return {};
  return {heap, std::size_t(raster_words(raster_edge(lod))) * voxels};
}

/// Levels from 5 on. rasters: of lod 4; then of the last one.
void filter_high_levels(DeviceHeap& heap, const Tables& tables, MipFilter filter,
                        const std::vector<VoxelsOut>& voxels_out, const CoarserBricks& bricks,
                        DeviceArray<std::uint32_t>& rasters) {
  for (std::size_t l = most_low_levels; l < bricks.levels.size(); ++l) {
    const DeviceLevel& level = bricks.levels[l];
    DeviceArray<std::uint32_t> own = room_for_rasters(heap, filter, int(l) + 1, level.voxels);
    filter_high(heap,
                {view_of(bricks.levels[l - 1]), bricks.starts[l].data(), level.first.data(), level.mask.data(),
                 level.bricks, voxels_out[l], rasters.data(), own.data(), filter},
                tables);
    rasters = std::move(own);
  }
}

}  // namespace

LevelsAbove coarser_levels(DeviceHeap& heap, const Tables& tables, const DeviceLevel& finest, int lods,
                           MipFilter filter, bool normals) {
  LevelsAbove above;
  if (lods < 2) return above;
  CoarserBricks bricks = coarser_bricks(heap, finest, lods);
  std::vector<VoxelsOut> voxels_out;
  for (DeviceLevel& level : bricks.levels) voxels_out.push_back(make_room(heap, filter, normals, level));
  LowLevels low{};
  low.fine = view_of(finest);
  low.levels = std::min(most_low_levels, lods - 1);
  for (int l = 0; l < low.levels; ++l) {
    const DeviceLevel& level = bricks.levels[std::size_t(l)];
    low.level[l] = {level.mask.data(), level.first.data(), voxels_out[std::size_t(l)]};
  }
  above.rasters = room_for_rasters(heap, filter, low.levels, bricks.levels[std::size_t(low.levels - 1)].voxels);
  low.key = bricks.levels[0].key.data();
  low.start = bricks.starts[0].data();
  low.ancestors = bricks.ancestors.data();
  low.bricks = bricks.levels[0].bricks;
  low.filter = filter;
  low.rasters = above.rasters.data();
  filter_low(heap, low, tables);
  filter_high_levels(heap, tables, filter, voxels_out, bricks, above.rasters);
  above.levels = std::move(bricks.levels);
  return above;
}

}  // namespace gigabake::kernels
