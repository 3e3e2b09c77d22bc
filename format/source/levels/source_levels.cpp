#include "format/source/levels/source_levels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <utility>

#include "core/base/error.h"
#include "core/octree/octree.h"
#include "format/source/levels/named_voxel_sizes.h"

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

/// Returns the level of a stated size; null: that of the scene.
std::uint8_t level_of(const SourceVoxelSize* size, double scene_m, const BakeParameters& p) {
  const int coarsest = std::countr_zero(p.cell_voxels) - 3;
  const double metres = size != nullptr ? size->metres : scene_m;
  const int lod = level_of(metres, p.voxel_size_m);
  if (lod >= 0 && lod <= coarsest) return std::uint8_t(lod);
  if (size == nullptr)
    throw UsageError("voxel_size_m",
                     fmt::format("{:g} m is not one of the {} levels of a cell of {} voxels over the finest voxel size "
                                 "of a source, {:g} m; use that size times a power of two, or larger cells",
                                 scene_m, coarsest + 1, p.cell_voxels, p.voxel_size_m));
  if (lod < 0)
    refuse(*size, fmt::format("is {:g} m; expected the finest voxel size of the scene, {:g} m, times a power "
                              "of two, such as {:g}",
                              metres, p.voxel_size_m,
                              std::ldexp(p.voxel_size_m, int(std::lround(std::log2(metres / p.voxel_size_m))))));
  refuse(*size,
         fmt::format("is {:g} m, coarser than the coarsest level of a cell, {:g} m; use at most this size, or larger "
                     "`cell_voxels`",
                     metres, std::ldexp(p.voxel_size_m, coarsest)));
}

/// Visits the voxel sizes that are stated for sources and for names in them. Each object may be visited several times.
template <class Visit>
void for_each_size(const std::vector<TileRef>& tiles, const Visit& visit) {
  for (const TileRef& tile : tiles) {
    if (tile.voxel_size) visit(*tile.voxel_size);
    if (!tile.named_sizes) continue;
    for (const auto* names : {&tile.named_sizes->of_materials, &tile.named_sizes->of_nodes})
      for (const NamedVoxelSizes::OfName& name : *names) visit(name.size);
  }
}

/// Returns the names with their levels. Raises p.coarsest_lod to the coarsest of them.
std::shared_ptr<const NamedVoxelSizes> with_levels(const NamedVoxelSizes& sizes, double scene_m, BakeParameters& p) {
  NamedVoxelSizes out = sizes;
  for (auto* names : {&out.of_materials, &out.of_nodes})
    for (NamedVoxelSizes::OfName& name : *names) {
      name.lod = level_of(&name.size, scene_m, p);
      p.coarsest_lod = std::max(p.coarsest_lod, std::uint32_t(name.lod));
    }
  return std::make_shared<const NamedVoxelSizes>(std::move(out));
}

}  // namespace

void set_source_levels(SceneSources& sources, BakeParameters& parameters) {
  const double scene_m = parameters.voxel_size_m;
  for_each_size(sources.tiles, [&parameters](const SourceVoxelSize& size) {
    parameters.voxel_size_m = std::min(parameters.voxel_size_m, size.metres);
  });
  parameters.coarsest_lod = parameters.depth_error != 0 ? std::uint32_t(max_ended_lod) : 0;
  std::map<const NamedVoxelSizes*, std::shared_ptr<const NamedVoxelSizes>> with_levels_of;
  for (TileRef& tile : sources.tiles) {
    tile.lod = level_of(tile.voxel_size.get(), scene_m, parameters);
    parameters.coarsest_lod = std::max(parameters.coarsest_lod, std::uint32_t(tile.lod));
    if (!tile.named_sizes) continue;
    std::shared_ptr<const NamedVoxelSizes>& named = with_levels_of[tile.named_sizes.get()];
    if (!named) named = with_levels(*tile.named_sizes, scene_m, parameters);
    tile.named_sizes = named;
  }
  check(parameters);
}

}  // namespace gigabake
