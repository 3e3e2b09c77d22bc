#include "format/source/source_levels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>

#include "core/base/error.h"
#include "core/octree/octree.h"

namespace gigabake {
namespace {

/// Max relative difference between a stated size and the size of its level.
constexpr double same_size = 1e-9;

[[noreturn]] void refuse(const SourceVoxelSize& size, const std::string& what) {
  throw UsageError(InputError(size.file, size.key, what).what());
}

/// Returns the level whose voxels have the size `metres`; -1 if there is none.
int level_of(double metres, double finest_m) {
  const int lod = int(std::lround(std::log2(metres / finest_m)));
  return lod >= 0 && std::fabs(std::ldexp(finest_m, lod) / metres - 1) < same_size ? lod : -1;
}

std::uint8_t level_of(const TileRef& tile, double scene_m, const BakeParameters& p) {
  const int coarsest = std::countr_zero(p.cell_voxels) - 3;
  const double metres = tile.voxel_size ? tile.voxel_size->metres : scene_m;
  const int lod = level_of(metres, p.voxel_size_m);
  if (lod >= 0 && lod <= coarsest) return std::uint8_t(lod);
  if (!tile.voxel_size)
    throw UsageError("voxel_size_m",
                     fmt::format("{:g} m is not one of the {} levels of a cell of {} voxels over the finest voxel size "
                                 "of a source, {:g} m; use that size times a power of two, or larger cells",
                                 scene_m, coarsest + 1, p.cell_voxels, p.voxel_size_m));
  if (lod < 0)
    refuse(*tile.voxel_size,
           fmt::format("is {:g} m; expected the finest voxel size of the scene, {:g} m, times a power "
                       "of two, such as {:g}",
                       metres, p.voxel_size_m,
                       std::ldexp(p.voxel_size_m, int(std::lround(std::log2(metres / p.voxel_size_m))))));
  refuse(*tile.voxel_size,
         fmt::format("is {:g} m, coarser than the coarsest level of a cell, {:g} m; use at most this size, or larger "
                     "`cell_voxels`",
                     metres, std::ldexp(p.voxel_size_m, coarsest)));
}

}  // namespace

void set_source_levels(SceneSources& sources, BakeParameters& parameters) {
  const double scene_m = parameters.voxel_size_m;
  for (const TileRef& tile : sources.tiles)
    if (tile.voxel_size) parameters.voxel_size_m = std::min(parameters.voxel_size_m, tile.voxel_size->metres);
  parameters.coarsest_lod = parameters.depth_error != 0 ? std::uint32_t(max_ended_lod) : 0;
  for (TileRef& tile : sources.tiles) {
    tile.lod = level_of(tile, scene_m, parameters);
    parameters.coarsest_lod = std::max(parameters.coarsest_lod, std::uint32_t(tile.lod));
  }
  check(parameters);
}

}  // namespace gigabake
