#include "bench/query/query_bench.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fmt/format.h>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <vector>

#include "bench/bench_scene.h"
#include "bench/query/cube_caster.h"
#include "core/base/error.h"
#include "format/scene/paged_scene.h"
#include "format/scene/shard_of_scene.h"
#include "format/shard/levels/brick_walk.h"
#include "query/first_hit_scene.h"
#include "query/scene_query.h"

namespace gigabake::bench {
namespace {

constexpr std::uint64_t max_voxels = std::uint64_t(1) << 23;
constexpr std::size_t batch_rays = std::size_t(1) << 17;
/// The penetration depth, in voxels, below which either caster may miss a voxel. It is twice the bound of SceneQuery
/// for cells of up to 1024 voxels (query/query_tree.h).
constexpr double slight = 1.0 / 64;

/// Returns every voxel of a level, of bricks and constant nodes, in coordinates of the level.
std::vector<Vec3i64> voxels_of(const PagedScene& scene, int lod) {
  std::vector<Vec3i64> voxels;
  scene.for_each_cell([&](const SceneCell& cell) {
    const ShardReader shard = open_shard_of_scene(scene.file(), scene.header(), cell);
    const NodeTable nodes = shard.nodes();
    const BrickLevel level = shard.level(lod);
    const Vec3i64 corner = cell.lattice_min >> lod;
    const auto add = [&](const Vec3i64& voxel) {
      if (voxels.size() >= max_voxels) throw UsageError("lod", "more than 2^23 voxels; expected a coarser level");
      voxels.push_back(voxel);
    };
    for (std::size_t n = 0; n < nodes.key.size(); ++n) {
      const int above = int(nodes.lod[n]) - lod;
      if (above < 0 || (above > 0 && nodes.kind[n] != NodeKind::leaf_constant)) continue;
      const std::int64_t edge = std::int64_t(brick_edge) << above;
      const Vec3i64 low = corner + Vec3i64(demorton(nodes.key[n])) * edge;
      if (nodes.kind[n] == NodeKind::brick) {
        for_each_voxel(level, nodes.value[n], {0, 0, 0},
                       [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t*, const std::int8_t*) {
                         add(low + Vec3i64{x, y, z});
                       });
        continue;
      }
      for (std::int64_t i = 0; i < edge * edge * edge; ++i)
        add(low + Vec3i64{i % edge, i / edge % edge, i / (edge * edge)});
    }
  });
  return voxels;
}

/// Returns rays from random points of the scene's box, enlarged by a tenth, in random directions.
std::vector<QueryRay> random_query_rays(const kernels::VoxelBox& box, std::size_t count, std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  std::vector<QueryRay> rays(count);
  for (QueryRay& ray : rays) {
    double length = 0;
    for (double& d : ray.direction) {
      d = normal(generator);
      length += d * d;
    }
    for (int a = 0; a < 3; ++a) {
      const double rim = 0.1 * double(box.max[a] - box.min[a]);
      ray.origin[a] =
          std::uniform_real_distribution<double>(double(box.min[a]) - rim, double(box.max[a]) + rim)(generator);
      ray.direction[a] /= std::sqrt(length);
    }
  }
  return rays;
}

/// Returns the part of the ray deeper than `slight` in a voxel; empty if there is none.
RayChord deep_chord(const QueryRay& ray, const Vec3i64& voxel, int lod) {
  kernels::VoxelBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.min[a] = voxel[a] << lod;
    box.max[a] = box.min[a] + (std::int64_t(1) << lod);
  }
  return chord_of(ray, box, -slight * kernels::power_of_two(lod));
}

class Comparison {
 public:
  Comparison(const CubeCaster& cubes, int lod, QueryBench& result) : cubes_(cubes), lod_(lod), result_(result) {}

  void add(const QueryRay& ray, const QueryHit& ours) {
    const double edge = kernels::power_of_two(lod_);
    const bool met = ours.outcome == QueryOutcome::hit;
    result_.hits += met ? 1 : 0;
    if (met && ours.distance < slight * edge) {
      ++result_.inside;
      return;
    }
    const auto theirs = cubes_.first_hit(Vec3d::from(ray.origin) / edge, Vec3d::from(ray.direction));
    const Vec3i64 our_voxel = Vec3i64::from(ours.voxel) >> lod_;
    if (met == theirs.has_value() && (!met || our_voxel == theirs->voxel)) return add_same(ray, ours, theirs);
    const double never = std::numeric_limits<double>::infinity();
    const double our_way = met ? ours.distance : never, their_way = theirs ? theirs->distance * edge : never;
    // The nearer hit is in a voxel that the other caster missed, or the ray hits both voxels at their common edge.
    const Vec3i64& passed = our_way < their_way ? our_voxel : theirs->voxel;
    if (std::fabs(our_way - their_way) < slight * edge || deep_chord(ray, passed, lod_).empty()) {
      ++result_.grazing;
      return;
    }
    tell_wrong(ray, our_way, their_way);
  }

 private:
  /// Adds hits of the same voxel. Distances differ if Embree enters by an open side and SceneQuery by a side that
  /// another voxel covers. Both missed the covering voxel.
  void add_same(const QueryRay& ray, const QueryHit& ours, const std::optional<CubeCaster::Hit>& theirs) {
    const double edge = kernels::power_of_two(lod_);
    const double gap = theirs ? std::fabs(theirs->distance * edge - ours.distance) : 0;
    if (gap < slight * edge) {
      ++result_.same;
      result_.max_gap = std::max(result_.max_gap, gap);
      return;
    }
    const double before_hit = ours.distance - 1e-6 * edge;
    const auto before = Vec3i64::by_axis(
        [&](int a) { return std::int64_t(std::floor((ray.origin[a] + ray.direction[a] * before_hit) / edge)); });
    if (before != theirs->voxel && deep_chord(ray, before, lod_).empty())
      ++result_.grazing;
    else
      tell_wrong(ray, ours.distance, theirs->distance * edge);
  }

  void tell_wrong(const QueryRay& ray, double our_way, double their_way) {
    if (result_.wrong++ == 0)
      result_.first_wrong =
          fmt::format("from {} {} {} to {} {} {}: query {}, Embree {}", ray.origin[0], ray.origin[1], ray.origin[2],
                      ray.direction[0], ray.direction[1], ray.direction[2], our_way, their_way);
  }

 private:
  const CubeCaster& cubes_;
  int lod_;
  QueryBench& result_;
};

bool is_equal(const QueryHit& a, const QueryHit& b) {
  return a.outcome == b.outcome && a.lod == b.lod && a.distance == b.distance && a.rgba == b.rgba &&
         a.shard == b.shard && std::ranges::equal(a.voxel, b.voxel) && std::ranges::equal(a.normal, b.normal);
}

/// Times a device and compares its answers with the CPU's.
class DeviceComparison {
 public:
  DeviceComparison(std::shared_ptr<const PagedScene> scene, const QueryBenchRequest& request, const ThreadPool& pool)
      : query_(std::move(scene), options(request), pool) {}

  void add(const std::vector<QueryRay>& rays, const std::vector<QueryHit>& on_cpu, QueryBench& result) {
    hits_.resize(rays.size());
    query_.first_hits(rays, hits_);  // uploads trees that are missing
    const auto start = Clock::now();
    query_.first_hits(rays, hits_);
    result.device_s += seconds_since(start);
    if (!query_.device_problem().empty()) throw CudaFailure(query_.device_problem());
    for (std::size_t i = 0; i < rays.size(); ++i) result.differ += is_equal(hits_[i], on_cpu[i]) ? 0 : 1;
    result.device_rays = query_.counts().device_rays;
  }

 private:
  static QueryOptions options(const QueryBenchRequest& request) {
    QueryOptions options{request.lod, 0, request.memory_bytes};
    options.device = [device = request.device] { return device; };
    options.min_device_rays = 1;
    return options;
  }

  SceneQuery query_;
  std::vector<QueryHit> hits_;
};

}  // namespace

QueryBench bench_queries(const QueryBenchRequest& request) {
  const ThreadPool pool(request.threads);
  const auto scene = std::make_shared<const PagedScene>(request.scene);
  SceneQuery query(scene, {request.lod, 0, request.memory_bytes}, pool);
  const CubeCaster cubes(voxels_of(*scene, request.lod), request.threads);
  QueryBench result;
  Comparison comparison(cubes, request.lod, result);
  std::optional<DeviceComparison> on_device;
  if (request.device) on_device.emplace(scene, request, pool);
  std::mt19937_64 generator(request.seed);
  while (result.rays < request.rays) {
    const auto count = std::size_t(std::min<std::uint64_t>(batch_rays, request.rays - result.rays));
    const std::vector<QueryRay> rays = random_query_rays(query.window(), count, generator);
    std::vector<QueryHit> hits(count);
    const auto with_trees = Clock::now();
    query.first_hits(rays, hits);
    result.build_and_query_s += seconds_since(with_trees);
    const auto alone = Clock::now();
    const std::clock_t busy = std::clock();
    query.first_hits(rays, hits);
    result.query_s += seconds_since(alone);
    result.cpu_s += double(std::clock() - busy) / CLOCKS_PER_SEC;
    if (on_device) on_device->add(rays, hits, result);
    for (std::size_t i = 0; i < count; ++i) comparison.add(rays[i], hits[i]);
    result.rays += count;
  }
  result.trees_built = query.counts().trees_built;
  return result;
}

}  // namespace gigabake::bench
