#include "format/export/voxel_tiles/voxel_tiling.h"

#include <algorithm>
#include <fmt/format.h>

#include "core/octree/morton.h"

namespace gigabake {
namespace {

/// The limits of tile edges in voxels. On terrain, a tile of 80³ voxels contains some hundred bricks. A tile of 112³
/// voxels, 114³ with padding, takes 5.9 MB of the 128 MiB that CesiumJS has for colours.
constexpr std::int64_t min_tile_edge = 80, max_tile_edge = 112;

std::int64_t rounded_up(std::int64_t a, std::int64_t b) { return a >= 0 ? (a + b - 1) / b : -(-a / b); }
std::int64_t rounded_down(std::int64_t a, std::int64_t b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

/// Returns the number of voxels of a level along the longest side of `bounds`.
std::int64_t extent(const Box3i64& bounds, int lod) {
  const Vec3i64 end = (bounds.end + Vec3i64::all((std::int64_t(1) << lod) - 1)) >> lod,
                size = end - (bounds.min >> lod);
  return std::max<std::int64_t>(1, *std::max_element(size.begin(), size.end()));
}

}  // namespace

Box3i64 VoxelTiling::padded_box(const TilePlace& tile) const {
  const LevelIndex min = (corner >> lod(tile.level)) + LevelIndex(demorton(tile.key)) * edge;
  return Box3i64::cube(min - LevelIndex::all(1), edge + 2);
}

Box3i64 VoxelTiling::tiles_near(int lod, const Box3i64& voxels) const {
  const std::int64_t maximum = std::int64_t(1) << level(lod);
  Box3i64 places;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::int64_t from = corner[c] >> lod;
    const std::int64_t low = (voxels.min[c] & ~std::int64_t(1)) - 2,
                       high = ((voxels.end[c] + 1) & ~std::int64_t(1)) + 2;
    places.min[c] = std::clamp<std::int64_t>(rounded_down(low - from, edge), 0, maximum);
    places.end[c] = std::clamp<std::int64_t>(rounded_up(high - from, edge), 0, maximum);
  }
  return places;
}

Box3i64 on_lattice(const Box3i64& voxels, int lod) { return {voxels.min << lod, voxels.end << lod}; }

VoxelTiling tiling_of(const Box3i64& bounds, int finest, std::uint32_t edge) {
  VoxelTiling tiling;
  tiling.finest = finest;
  int lod = finest;
  while (extent(bounds, lod) > (edge != 0 ? std::int64_t(edge) : max_tile_edge)) ++lod;
  tiling.levels = std::uint32_t(lod - finest) + 1;
  const std::int64_t fitting = extent(bounds, lod);
  tiling.edge = edge != 0 ? edge : std::uint32_t(lod == finest ? fitting : std::max(fitting, min_tile_edge));
  tiling.corner = bounds.min >> lod << lod;
  return tiling;
}

std::string path_of(const TilePlace& tile) {
  const BrickCoordinate at = demorton(tile.key);
  return fmt::format("{}/{}/{}/{}", tile.level, at.x, at.y, at.z);
}

}  // namespace gigabake
