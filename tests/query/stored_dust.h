/// Scenes of single voxels in up to eight stored cells, and rays through them.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/math/vec3.h"
#include "core/octree/parameters.h"
#include "format/scene/paged_scene.h"
#include "query/scene_query.h"
#include "tests/format/shard/made_shard.h"

namespace gigabake::query_test {

using made::TempFolder;
using DustCells = std::vector<Shard>;
using CellCorner = Vec3i64;

inline constexpr std::int64_t dust_cell_edge = 32, dust_edge = 64;

/// Returns true for 1/sparsity of the voxels of [0, 64)³.
inline bool is_dust(std::int64_t x, std::int64_t y, std::int64_t z, std::uint64_t sparsity) {
  if (x < 0 || y < 0 || z < 0 || x >= dust_edge || y >= dust_edge || z >= dust_edge) return false;
  std::uint64_t hash = std::uint64_t(x) | std::uint64_t(y) << 20 | std::uint64_t(z) << 40;
  hash = (hash ^ hash >> 31) * 0x7fb5d329728ea185u;
  hash = (hash ^ hash >> 27) * 0x81dadef4bc2dd44du;
  return (hash ^ hash >> 33) % sparsity == 0;
}

/// Returns up to eight cells; the colour of a voxel encodes its position.
template <class Exists>
DustCells dust_cells(const Exists& exists) {
  DustCells cells;
  for (std::int64_t c = 0; c < 8; ++c) {
    const CellCorner min{(c & 1) * dust_cell_edge, (c >> 1 & 1) * dust_cell_edge, (c >> 2) * dust_cell_edge};
    std::vector<made::Voxel> voxels;
    for (std::int64_t z = min[2]; z < min[2] + dust_cell_edge; ++z)
      for (std::int64_t y = min[1]; y < min[1] + dust_cell_edge; ++y)
        for (std::int64_t x = min[0]; x < min[0] + dust_cell_edge; ++x)
          if (exists(x, y, z))
            voxels.push_back({{x, y, z}, {std::uint8_t(x), std::uint8_t(y), std::uint8_t(z), 255}, {}});
    if (voxels.empty()) continue;
    Shard cell = made::shard_of(voxels, min, dust_cell_edge);
    cell.header.cell = "c_" + std::to_string(c & 1) + "_" + std::to_string(c >> 1 & 1) + "_" + std::to_string(c >> 2);
    cells.push_back(std::move(cell));
  }
  return cells;
}

struct StoredDust {
  TempFolder folder;
  SceneDescription description;

  explicit StoredDust(const DustCells& cells) {
    description = made::write_scene_of(folder / "scene.xml", cells);
    description.parameters = to_json(BakeParameters{.voxel_size_m = description.voxel_size_m});
  }
  std::shared_ptr<const PagedScene> open() const {
    return std::make_shared<const PagedScene>(PagedScene::of_cells(folder / "scene.xml", description));
  }
};

inline QueryRay query_ray(const std::array<double, 3>& origin, const std::array<double, 3>& direction) {
  QueryRay ray;
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  for (std::size_t a = 0; a < 3; ++a) {
    ray.origin[a] = origin[a];
    ray.direction[a] = direction[a] / length;
  }
  return ray;
}

inline std::vector<QueryRay> random_query_rays(std::mt19937_64& rng, std::size_t count) {
  std::uniform_real_distribution<double> place(-20, 84);
  std::normal_distribution<double> way;
  std::vector<QueryRay> rays;
  while (rays.size() < count)
    rays.push_back(query_ray({place(rng), place(rng), place(rng)}, {way(rng), way(rng), way(rng)}));
  return rays;
}

inline std::vector<QueryHit> answers_of(SceneQuery& query, const std::vector<QueryRay>& rays) {
  std::vector<QueryHit> hits(rays.size());
  query.first_hits(rays, hits);
  return hits;
}

}  // namespace gigabake::query_test
