#include "kernels/cpu/mip/downsample_state.h"

#include <bit>
#include <cstring>

#include "core/octree/brick.h"
#include "core/octree/morton.h"
#include "kernels/body/mip/mip.h"
#include "kernels/cpu/mip/level_read.h"

namespace gigabake::kernels {
namespace {

void add_places(const Level& level, std::uint8_t below, std::vector<std::uint8_t>& place) {
  for (std::size_t b = 0; b < level.key.size(); ++b) {
    const BrickCoordinate at = demorton(level.key[b]);
    for (int z = 0; z < brick_edge; ++z)
      for (std::uint64_t rest = level.mask[8 * b + std::size_t(z)]; rest != 0; rest &= rest - 1) {
        const int bit = std::countr_zero(rest);
        place.insert(place.end(), {below, std::uint8_t(brick_edge * at.x + std::uint32_t(bit & 7)),
                                   std::uint8_t(brick_edge * at.y + std::uint32_t(bit >> 3)),
                                   std::uint8_t(brick_edge * at.z + std::uint32_t(z))});
      }
  }
}

void add_level(const Level& level, std::uint8_t below, DownsampleState& source) {
  add_places(level, below, source.place);
  source.rgba.insert(source.rgba.end(), level.rgba.begin(), level.rgba.end());
  source.normal.insert(source.normal.end(), level.normal.begin(), level.normal.end());
  source.voxel_class.insert(source.voxel_class.end(), level.voxel_class.begin(), level.voxel_class.end());
}

template <class T>
std::vector<std::uint8_t> bytes_of_all(const std::vector<T>& items) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(items.data());
  return {bytes, bytes + items.size() * sizeof(T)};
}

/// Returns the patches of level 0; none if the level has no planes.
std::vector<SurfaceMoments> finest_patches(const Level& finest) {
  const Tables tables = TableStore::host().view();
  std::vector<SurfaceMoments> patches;
  for (std::size_t i = 0; i < finest.directional_coverage.size() / directional_coverage_bytes; ++i)
    patches.push_back(finest_patch_at(finest, i, unit_normal_of(&finest.normal[2 * i], tables)));
  return patches;
}

}  // namespace

DownsampleState downsample_state(const std::vector<Level>& levels, int lod, const LevelSurface& surface,
                                 MipFilter filter) {
  static_assert(sizeof(SurfaceMoments) == source_patch_bytes && std::endian::native == std::endian::little);
  DownsampleState source;
  if (levels.empty()) return source;
  add_level(levels.back(), 0, source);
  if (is_of_64(filter, lod + 1)) add_level(levels[levels.size() - 2], 1, source);
  source.raster = bytes_of_all(surface.rasters);
  source.patch = bytes_of_all(lod == 0 ? finest_patches(levels.back()) : surface.patches);
  return source;
}

}  // namespace gigabake::kernels
