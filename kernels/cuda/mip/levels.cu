#include <algorithm>

#include "core/base/rules.h"
#include "kernels/cuda/mip/filter_high.cuh"
#include "kernels/cuda/mip/filter_low.cuh"
#include "kernels/cuda/mip/levels.cuh"
#include "kernels/cuda/mip/two_level_filter.cuh"

namespace gigabake::kernels {
namespace {

VoxelsOut make_room(DeviceHeap& heap, MipFilter filter, bool normals, DeviceLevel& level) {
  level.rgba = DeviceArray<std::uint32_t>(heap, level.voxels);
  if (normals) level.normal = DeviceArray<std::uint16_t>(heap, level.voxels);
  if (filters_by_view(filter))
    level.directional_coverage =
        DeviceArray<std::uint8_t>(heap, directional_coverage_bytes * std::size_t(level.voxels));
  return {level.rgba.data(), level.normal.data(), level.directional_coverage.data(), nullptr};
}

DeviceArray<std::uint32_t> room_for_rasters(DeviceHeap& heap, MipFilter filter, int lod, std::uint32_t voxels) {
  if (!filters_by_view(filter)) return {};
  return {heap, std::size_t(raster_words(raster_edge(lod))) * voxels};
}

/// Returns the number of levels from lod 1 on that one launch filters. Their voxels are filtered from eight children.
int low_levels(MipFilter filter, int lods) {
  int levels = 0;
  while (levels < max_low_levels && levels + 1 < lods && !is_of_64(filter, levels + 1)) ++levels;
  return levels;
}

/// Filters the levels coarser than lod `low`. On entry, `rasters` holds the coverage masks of lod `low`; on return, it
/// holds those for the coarsest level.
void filter_high_levels(DeviceHeap& heap, const Tables& tables, MipFilter filter, int low, const DeviceLevel& finest,
                        const std::vector<VoxelsOut>& voxels_out, const CoarserBricks& bricks,
                        DeviceArray<std::uint32_t>& rasters) {
  for (std::size_t l = std::size_t(low); l < bricks.levels.size(); ++l) {
    const DeviceLevel& level = bricks.levels[l];
    if (is_of_64(filter, int(l) + 1)) {
      const DeviceLevel& fine = l == 1 ? finest : bricks.levels[l - 2];
      two_level_filter_level(
          heap, {view_of(fine), level.key.data(), level.first.data(), level.mask.data(), level.bricks, voxels_out[l]},
          tables);
      continue;
    }
    DeviceArray<std::uint32_t> own = room_for_rasters(heap, filter, int(l) + 1, level.voxels);
    filter_high(heap,
                {view_of(bricks.levels[l - 1]), bricks.starts[l].data(), level.first.data(), level.mask.data(),
                 level.bricks, voxels_out[l], rasters.data(), own.data(), voxels_out[l - 1].patch, filter},
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
  low.levels = low_levels(filter, lods);
  std::vector<DeviceArray<SurfaceMoments>> patches(bricks.levels.size());
  for (std::size_t l = std::size_t(low.levels) - 1; filters_by_view(filter) && normals && l < patches.size(); ++l) {
    patches[l] = DeviceArray<SurfaceMoments>(heap, bricks.levels[l].voxels);
    voxels_out[l].patch = patches[l].data();
  }
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
  filter_high_levels(heap, tables, filter, low.levels, finest, voxels_out, bricks, above.rasters);
  above.patches = std::move(patches.back());
  above.levels = std::move(bricks.levels);
  return above;
}

}  // namespace gigabake::kernels
