#include "bench/hard/hard_bake.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "bench/bench_scene.h"
#include "bench/hard/exact_place.h"
#include "core/base/error.h"
#include "format/shard/levels/leaf_walk.h"
#include "format/source/classes/source_classes.h"
#include "worker/pipeline/lattice.h"

namespace gigabake::bench {
namespace {

CellJob job_of(const HardCase& hard, std::size_t tiles) {
  CellJob job;
  job.name = "cell";
  job.lattice_min = hard.window.min;
  job.cell_voxels = std::uint32_t(hard.window.edge);
  job.tiles.resize(tiles);
  std::iota(job.tiles.begin(), job.tiles.end(), 0u);
  return job;
}

double distance(const LongPoint& a, const LongPoint& b) {
  const LongPoint d = a - b;
  return double(hypotl(hypotl(d[0], d[1]), d[2]));
}

/// Returns the vertex in double, with the same steps as core/math/snap.h.
LongPoint in_double(const std::array<double, 12>& m, const float* local) {
  LongPoint p;
  for (std::size_t r = 0; r < 3; ++r)
    p[r] = ((m[4 * r] * local[0] + m[4 * r + 1] * local[1]) + m[4 * r + 2] * local[2]) + m[4 * r + 3];
  return p;
}

LongPoint middle_of(const LatticePoint& at, const BakeParameters& parameters) {
  return LongPoint(at.v) * parameters.voxel_size_m / 256 + LongPoint(parameters.lattice_origin_m);
}

/// Compares the vertices of the pipeline with the exact vertices.
void measure_places(const HardScene& scene, const SceneSources& sources, const BakeParameters& parameters,
                    HardBake& out) {
  const std::vector<LongAffine> exact = exact_placements(scene, sources.origin);
  auto placement = exact.begin();
  for (const TileRef& tile : sources.tiles) {
    const TileMesh mesh = read_tile(tile, sources.root, ReadScope::positions_only);
    for (const Instance& instance : mesh.instances) {
      const std::array<double, 12> m = row_major(instance.scene_from_local);
      const std::vector<float>& position = mesh.primitives[std::size_t(instance.primitive)].position;
      for (std::size_t v = 0; v + 2 < position.size(); v += 3) {
        LatticePoint at;
        if (!snap(snap_frame(parameters), m.data(), &position[v], at)) continue;
        const LongPoint p = *placement * LongPoint::from(&position[v]);
        out.placement_m = std::max(out.placement_m, distance(in_double(m, &position[v]), p));
        out.position_m = std::max(out.position_m, distance(middle_of(at, parameters), p));
      }
      ++placement;
    }
  }
}

StoredVoxel stored(const std::uint8_t* rgba, const std::int8_t* normal, const std::uint8_t* directional_coverage,
                   VoxelClass voxel_class) {
  StoredVoxel v;
  std::copy_n(rgba, 4, v.rgba.begin());
  std::copy_n(normal, 2, v.normal.begin());
  if (directional_coverage != nullptr) v.plane = directional_coverage[directional_coverage_plane];
  v.voxel_class = voxel_class;
  return v;
}

StoredVoxels voxels_of(const Shard& shard) {
  StoredVoxels out;
  for_each_voxel_of_level(shard.nodes, shard.levels[0], 0,
                          [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba,
                              const std::int8_t* normal, const std::uint8_t* coverage, VoxelClass voxel_class) {
                            const Vec3i64 at = shard.header.lattice_min + Vec3i64{x, y, z};
                            out[at] = stored(rgba, normal, coverage, voxel_class);
                          });
  return out;
}

std::vector<StoredVoxels> leaves_of(const Shard& shard) {
  std::vector<StoredVoxels> out(shard.levels.size() - 1);
  for_each_leaf_octant(shard.nodes, shard.levels, 0, 0, [&](const LeafVoxels& leaves) {
    const Vec3i64 corner = (shard.header.lattice_min >> leaves.lod) + leaves.octant * 4;
    StoredVoxels& of_level = out.at(std::size_t(leaves.lod) - 1);
    for_each_leaf(leaves, [&](const Vec3<int>& at, const std::uint8_t* rgba, const std::int8_t* normal,
                              const std::uint8_t* coverage, VoxelClass voxel_class) {
      of_level[corner + static_cast<Vec3i64>(at)] = stored(rgba, normal, coverage, voxel_class);
    });
  });
  return out;
}

/// Sets what a scene .json would state about each tile.
void set_levels_and_classes(const HardScene& scene, SceneSources& sources) {
  for (std::size_t i = 0; i < scene.tiles.size(); ++i) {
    const HardTile& tile = scene.tiles[i];
    sources.tiles.at(i).lod = std::uint8_t(tile.lod);
    if (tile.voxel_class == no_class) continue;
    SourceClasses classes;
    classes.of_source = tile.voxel_class;
    sources.tiles[i].classes = std::make_shared<const SourceClasses>(std::move(classes));
  }
}

BakeParameters parameters_of(const HardCase& hard, const HardScene& scene) {
  BakeParameters parameters = hard.parameters;
  parameters.cell_voxels = std::uint32_t(hard.window.edge);
  for (const HardTile& tile : scene.tiles) {
    parameters.coarsest_lod = std::max(parameters.coarsest_lod, std::uint32_t(tile.lod));
    parameters.classes = parameters.classes || tile.voxel_class != no_class;
  }
  return parameters;
}

}  // namespace

SceneSources open_hard(const std::filesystem::path& folder, const HardScene& scene) {
  std::error_code ignored;  // if the folder cannot be removed, an error follows below
  std::filesystem::remove_all(folder, ignored);
  SourceOptions options;
  options.local = !scene.on_earth;
  options.origin = scene.origin;
  SceneSources sources = open_sources(write_scene(folder, scene), options);
  set_levels_and_classes(scene, sources);
  return sources;
}

HardBake bake_hard(const std::filesystem::path& folder, const HardScene& scene, const HardCase& hard,
                   const HardMachine& machine, const SceneSources& sources) {
  HardBake out;
  const BakeParameters parameters = parameters_of(hard, scene);
  measure_places(scene, sources, parameters, out);
  WorkerOptions worker{machine.threads, 0, folder, machine.cuda_device};
  CellPipeline pipeline(sources, parameters, worker);
  out.report = bake_cells(pipeline, {job_of(hard, sources.tiles.size())}, 1).at(0);
  if (out.report.outcome != CellOutcome::baked) return out;
  const Shard shard = read_shard(folder / out.report.cell.file);
  out.voxels = voxels_of(shard);
  out.leaves = leaves_of(shard);
  out.content_hash = shard.header.content_hash.at(0).hex();
  return out;
}

}  // namespace gigabake::bench
