#include "bench/pages/painted_overview.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "core/octree/morton.h"
#include "format/shard/levels/content_hash.h"
#include "kernels/cpu/prune/prune.h"
#include "worker/pipeline/shard_from_volume.h"

namespace gigabake {
namespace {

/// The position of a voxel: its brick's Morton code, and its bit in the brick.
using Place = std::pair<std::uint64_t, std::uint32_t>;

Place place_of(std::int64_t x, std::int64_t y, std::int64_t z) {
  return {morton(std::uint32_t(x >> 3), std::uint32_t(y >> 3), std::uint32_t(z >> 3)),
          std::uint32_t((x & 7) + 8 * (y & 7) + 64 * (z & 7))};
}

/// Returns the surface voxels of the window's finest level. Each column also contains the voxels that connect it with
/// its western and southern neighbours, so that there is no hole.
std::vector<Place> finest_places(const CellJob& overview, const SurfaceHeight& height) {
  const std::int64_t width = overview.cell_voxels >> overview.first_lod;
  const double voxel = std::ldexp(1, int(overview.first_lod));
  const auto row_of = [&](std::int64_t i, std::int64_t j) {
    const double x = double(overview.lattice_min[0]) + (double(i) + .5) * voxel;
    const double y = double(overview.lattice_min[1]) + (double(j) + .5) * voxel;
    return std::int64_t(std::floor((height(x, y) - double(overview.lattice_min[2])) / voxel));
  };
  std::vector<Place> places;
  std::vector<std::int64_t> south(std::size_t(width) + 1);
  for (std::int64_t i = -1; i < width; ++i) south[std::size_t(i + 1)] = row_of(i, -1);
  for (std::int64_t j = 0; j < width; ++j) {
    std::int64_t west = row_of(-1, j);
    for (std::int64_t i = 0; i < width; ++i) {
      const std::int64_t here = row_of(i, j);
      const std::int64_t low = std::min({here, west + 1, south[std::size_t(i + 1)] + 1});
      const std::int64_t high = std::max({here, west - 1, south[std::size_t(i + 1)] - 1});
      for (std::int64_t z = std::max<std::int64_t>(low, 0); z <= std::min(high, width - 1); ++z)
        places.push_back(place_of(i, j, z));
      west = south[std::size_t(i + 1)] = here;
    }
  }
  if (places.empty()) places.push_back(place_of(width / 2, width / 2, width / 2));
  std::sort(places.begin(), places.end());
  return places;
}

/// Returns the voxels of the next coarser level: a voxel exists if one of its eight children exists.
std::vector<Place> coarser(const std::vector<Place>& places) {
  std::vector<Place> above;
  for (const auto& [brick, bit] : places) {
    const std::uint32_t octant = std::uint32_t(brick & 7);
    const std::uint32_t x = 4 * (octant & 1) + (bit & 7) / 2, y = 4 * (octant >> 1 & 1) + (bit >> 3 & 7) / 2,
                        z = 4 * (octant >> 2) + (bit >> 6) / 2;
    above.emplace_back(brick >> 3, x + 8 * y + 64 * z);
  }
  std::sort(above.begin(), above.end());
  above.erase(std::unique(above.begin(), above.end()), above.end());
  return above;
}

kernels::Level level_of(const std::vector<Place>& places) {
  kernels::Level level;
  for (const auto& [brick, bit] : places) {
    if (level.key.empty() || level.key.back() != brick) {
      level.key.push_back(brick);
      level.first.push_back(level.rgba.size() / 4);
      level.mask.resize(level.mask.size() + 8);
    }
    (level.mask.end() - 8)[bit >> 6] |= std::uint64_t(1) << (bit & 63);
    const auto shade = std::uint8_t((brick ^ brick >> 1) % 3 * 40);
    level.rgba.insert(level.rgba.end(), {std::uint8_t(90 + shade), std::uint8_t(140 - shade / 2), 80, 255});
    level.normal.insert(level.normal.end(), {0, 0});
    level.directional_coverage.insert(level.directional_coverage.end(), {255, 255, 255, 0});
  }
  level.first.push_back(level.rgba.size() / 4);
  return level;
}

}  // namespace

Shard painted_overview(const CellJob& overview, const SurfaceHeight& height, double voxel_size_m) {
  kernels::CellVolume volume;
  std::vector<Place> places = finest_places(overview, height);
  for (std::uint32_t width = overview.cell_voxels >> overview.first_lod; width >= brick_edge; width /= 2) {
    volume.levels.push_back(level_of(places));
    places = coarser(places);
  }
  volume.nodes = kernels::brick_nodes(volume.levels);
  ShardHeader header;
  header.generator = "gigabake made_scene";
  header.cell = overview.name;
  header.lattice_min = overview.lattice_min;
  header.cell_voxels = overview.cell_voxels;
  header.first_lod = overview.first_lod;
  header.copied_lods = overview.copied_lods;
  header.voxel_size_m = voxel_size_m;
  header.fingerprint = overview.fingerprint;
  header.has_directional_coverage = true;
  Shard shard = shard_from_volume(std::move(volume), std::move(header));
  shard.header.content_hash = content_hash(shard);
  return shard;
}

}  // namespace gigabake
