#include "bench/hard/hard_bake.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "bench/bench_scene.h"
#include "bench/hard/exact_place.h"
#include "core/base/error.h"
#include "format/shard/levels/brick_walk.h"
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

StoredVoxels voxels_of(const Shard& shard) {
  StoredVoxels out;
  const auto& low = shard.header.lattice_min;
  for_each_voxel_of_level(
      shard.nodes, shard.levels[0], 0,
      [&](std::int64_t x, std::int64_t y, std::int64_t z, const std::uint8_t* rgba, const std::int8_t* normal) {
        StoredVoxel v;
        std::copy_n(rgba, 4, v.rgba.begin());
        std::copy_n(normal, 2, v.normal.begin());
        out[low + Vec3i64{x, y, z}] = v;
      });
  return out;
}

}  // namespace

SceneSources open_hard(const std::filesystem::path& folder, const HardScene& scene) {
  std::error_code ignored;  // if the folder cannot be removed, an error follows below
  std::filesystem::remove_all(folder, ignored);
  SourceOptions options;
  options.local = !scene.on_earth;
  options.origin = scene.origin;
  return open_sources(write_scene(folder, scene), options);
}

HardBake bake_hard(const std::filesystem::path& folder, const HardScene& scene, const HardCase& hard,
                   const HardMachine& machine, const SceneSources& sources) {
  HardBake out;
  BakeParameters parameters = hard.parameters;
  parameters.cell_voxels = std::uint32_t(hard.window.edge);
  measure_places(scene, sources, parameters, out);
  WorkerOptions worker{machine.threads, 0, folder, machine.cuda_device};
  CellPipeline pipeline(sources, parameters, worker);
  out.report = bake_cells(pipeline, {job_of(hard, sources.tiles.size())}, 1).at(0);
  if (out.report.outcome != CellOutcome::baked) return out;
  const Shard shard = read_shard(folder / out.report.cell.file);
  out.voxels = voxels_of(shard);
  out.content_hash = shard.header.content_hash.at(0).hex();
  return out;
}

}  // namespace gigabake::bench
