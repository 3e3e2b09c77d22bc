#include "format/export/voxel_tiles/voxel_tiling.h"

#include <algorithm>
#include <fmt/format.h>

#include "core/octree/morton.h"

namespace gigabake {
namespace {

/// Range   of tile edges. On terrain, a tile of 80³ voxels contains some hundred bricks. A tile of 114³ with padding
///         takes 5.9 MB of colours, of the 128 MiB that CesiumJS has for them.
constexpr std::int64_t min_tile_edge = 80, max_tile_edge = 112;

std::int64_t rounded_up(std::int64_t a, std::int64_t b) { return a >= 0 ? (a + b - 1) / b : -(-a / b); }
std::int64_t rounded_down(std::int64_t a, std::int64_t b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

/// Returns the number of voxels of a level along the longest side of `bounds`.
std::int64_t extent(const LatticeBox& bounds, int lod) {
  std::int64_t maximum = 1;
  for (std::size_t c = 0; c < 3; ++c)
    maximum = std::max(maximum, ((bounds.end[c] + (std::int64_t(1) << lod) - 1) >> lod) - (bounds.min[c] >> lod));
  return maximum;
}

}  // namespace

LevelBox VoxelTiling::padded_box(const TilePlace& tile) const {
  const BrickCoordinate at = demorton(tile.key);
  const std::array<std::uint32_t, 3> place{at.x, at.y, at.z};
  LevelBox box;
  for (std::size_t c = 0; c < 3; ++c) {
    box.min[c] = (corner[c] >> lod(tile.level)) + std::int64_t(place[c]) * edge - 1;
    box.end[c] = box.min[c] + edge + 2;
  }
  return box;
}

LevelBox VoxelTiling::tiles_near(int lod, const LevelBox& voxels) const {
  const std::int64_t maximum = std::int64_t(1) << level(lod);
  LevelBox places;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::int64_t from = corner[c] >> lod;
    const std::int64_t low = (voxels.min[c] & ~std::int64_t(1)) - 2,
                       high = ((voxels.end[c] + 1) & ~std::int64_t(1)) + 2;
    places.min[c] = std::clamp<std::int64_t>(rounded_down(low - from, edge), 0, maximum);
    places.end[c] = std::clamp<std::int64_t>(rounded_up(high - from, edge), 0, maximum);
  }
  return places;
}

LatticeBox on_lattice(const LevelBox& voxels, int lod) {
  LatticeBox box;
  for (std::size_t c = 0; c < 3; ++c) {
    box.min[c] = voxels.min[c] * (std::int64_t(1) << lod);
    box.end[c] = voxels.end[c] * (std::int64_t(1) << lod);
  }
  return box;
}

VoxelTiling tiling_of(const LatticeBox& bounds, int finest, std::uint32_t edge) {
  VoxelTiling tiling;
  tiling.finest = finest;
  int lod = finest;
  while (extent(bounds, lod) > (edge != 0 ? std::int64_t(edge) : max_tile_edge)) ++lod;
  tiling.levels = std::uint32_t(lod - finest) + 1;
  const std::int64_t fitting = extent(bounds, lod);
  tiling.edge = edge != 0 ? edge : std::uint32_t(lod == finest ? fitting : std::max(fitting, min_tile_edge));
  for (std::size_t c = 0; c < 3; ++c) tiling.corner[c] = bounds.min[c] >> lod << lod;
  return tiling;
}

std::string path_of(const TilePlace& tile) {
  const BrickCoordinate at = demorton(tile.key);
  return fmt::format("{}/{}/{}/{}", tile.level, at.x, at.y, at.z);
}

}  // namespace gigabake
