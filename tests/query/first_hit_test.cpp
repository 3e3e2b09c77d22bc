// First hits compared with a traversal from voxel to voxel in double precision.
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/first_hit/first_hit_reference.h"
#include "first_hit_scenes.h"
#include "query/first_hit/first_hit_cast.h"
#include "query/first_hit_scene.h"

namespace gigabake {
namespace {

using bench::Agreement;
using kernels::FirstHit;
using kernels::FirstHitRay;
using namespace first_hit_test;

/// Returns the error bound of query/first_hit/first_hit.h.
double rounding_of(const FirstHitScene& scene) { return double(1 << scene.view.tree.bits) * 0x1p-20; }

std::vector<FirstHit> cast(const FirstHitScene& scene, const std::vector<FirstHitRay>& rays) {
  const ThreadPool pool(2);
  std::vector<FirstHit> hits(rays.size());
  kernels::cast_first_hits(scene.view, {rays.data(), rays.size()}, {{hits.data(), hits.size()}, {}}, pool);
  return hits;
}

/// Numbers of rays that equal the reference, that equal it up to rounding, and that hit. A wrong ray fails the test.
struct Score {
  int same = 0, close = 0, met = 0;
};

Score score(const FirstHitScene& scene, const Painter& paint, const std::vector<FirstHitRay>& rays,
            const std::vector<FirstHit>& hits) {
  const auto exists = [&](const bench::Voxel& v) {
    return paint(scene.lattice_min[0] + v[0], scene.lattice_min[1] + v[1], scene.lattice_min[2] + v[2]).has_value();
  };
  Score s;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Agreement agreement = bench::compare(scene.view.tree, rays[i], hits[i], rounding_of(scene), exists);
    const FirstHitRay& r = rays[i];
    EXPECT_NE(agreement, Agreement::wrong)
        << "ray " << i << " of seed " << seed << " from " << r.origin[0] << " " << r.origin[1] << " " << r.origin[2]
        << " to " << r.direction[0] << " " << r.direction[1] << " " << r.direction[2];
    s.same += agreement == Agreement::same;
    s.close += agreement == Agreement::within_rounding;
    s.met += hits[i].attributes_index != kernels::no_attributes;
  }
  return s;
}

Score score(const FirstHitScene& scene, const Painter& paint, const std::vector<FirstHitRay>& rays) {
  return score(scene, paint, rays, cast(scene, rays));
}

TEST(FirstHit, AgreesWithTheReferenceForRandomRaysThroughDust) {
  for (const std::uint64_t sparsity : {2u, 20u, 400u, 20000u}) {
    SCOPED_TRACE(sparsity);
    VoxelScene voxels(32);
    voxels.add_cells(dust(sparsity), {0, 0, 0}, 64);
    const Score s = score(build(voxels), dust(sparsity), random_rays(20000, -20, 84));
    EXPECT_LT(s.close, 20);
    EXPECT_GT(s.met, 20);
  }
}

TEST(FirstHit, MeetsTheVoxelItStartsInAtDistanceZero) {
  VoxelScene voxels(32);
  voxels.add_cells(dust(2), {0, 0, 0}, 64);
  const FirstHitScene scene = build(voxels);
  std::vector<FirstHitRay> rays;
  for (const FirstHitRay& r : random_rays(20000, 0, 64)) {
    bool inside = dust(2)(std::int64_t(r.origin[0]), std::int64_t(r.origin[1]), std::int64_t(r.origin[2])).has_value();
    for (const double o : r.origin) inside = inside && std::fabs(o - std::round(o)) > rounding_of(scene);
    if (inside) rays.push_back(r);
  }
  const std::vector<FirstHit> hits = cast(scene, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(hits[i].distance, 0);
    for (std::size_t a = 0; a < 3; ++a)
      EXPECT_EQ(scene.lattice_min[a] + std::int64_t(hits[i].voxel >> 21 * a & 0x1fffff),
                std::int64_t(rays[i].origin[a]));
  }
}

TEST(FirstHit, AgreesForRaysAlongAxesFacesEdgesAndThroughCorners) {
  VoxelScene voxels(32);
  voxels.add_cells(dust(200), {0, 0, 0}, 64);
  const FirstHitScene scene = build(voxels);
  std::mt19937_64 generator(seed);
  std::uniform_int_distribution<int> place(-8, 72), side(-1, 1), half(0, 1);
  std::vector<FirstHitRay> rays;
  while (rays.size() < 30000) {
    std::array<double, 3> origin{}, direction{};
    for (std::size_t a = 0; a < 3; ++a) {
      origin[a] = place(generator) + 0.5 * half(generator);
      direction[a] = side(generator);
    }
    if (direction != std::array<double, 3>{}) rays.push_back(ray(origin, direction));
  }
  EXPECT_GT(score(scene, dust(200), rays).met, 3000);
}

TEST(FirstHit, AnAxisParallelRayOnAFaceBelongsToTheUpperVoxel) {
  const Painter two = [](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
    if (z != 9 || y != 9 || (x != 4 && x != 5)) return {};
    return Paint{};
  };
  VoxelScene voxels(32);
  voxels.add_cell(two, {0, 0, 0});
  const FirstHitScene scene = build(voxels);
  const std::vector<FirstHit> hits =
      cast(scene, {ray({5, 9.5, 30}, {0, 0, -1}), ray({6, 9.5, 30}, {0, 0, -1}), ray({4, 9.5, -3}, {0, 0, 1})});
  EXPECT_EQ(scene.lattice_min[0] + std::int64_t(hits[0].voxel & 0x1fffff), 5);
  EXPECT_EQ(hits[0].distance, 20);
  EXPECT_EQ(hits[1].attributes_index, kernels::no_attributes);
  EXPECT_EQ(scene.lattice_min[0] + std::int64_t(hits[2].voxel & 0x1fffff), 4);
  EXPECT_EQ(hits[2].distance, 12);
}

/// Stairs of voxels that share only edges.
TEST(FirstHit, DoesNotSlipBetweenVoxelsThatShareAnEdge) {
  const Painter stair = [](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
    if (x + y != 63 || z < 0 || z >= 64 || x < 0 || y < 0) return {};
    return Paint{};
  };
  VoxelScene voxels(32);
  voxels.add_cells(stair, {0, 0, 0}, 64);
  const FirstHitScene scene = build(voxels);
  std::mt19937_64 generator(seed);
  std::uniform_int_distribution<int> edge(8, 55);
  std::uniform_real_distribution<double> tiny(-1e-4, 1e-4), height(20, 40), away(5, 2000), up(-0.1, 0.1);
  std::vector<FirstHitRay> rays;
  for (int i = 0; i < 50000; ++i) {
    const double x = edge(generator), y = 64 - x, z = height(generator), far = away(generator);
    const double wobble = tiny(generator), rise = up(generator) / far;
    const std::array<double, 3> direction{1, 1 + wobble / far, rise};
    rays.push_back(ray({x - far, y - far * direction[1], z - far * rise}, direction));
  }
  for (const FirstHit& hit : cast(scene, rays)) ASSERT_NE(hit.attributes_index, kernels::no_attributes);
}

TEST(FirstHit, AgreesForOriginsFarAway) {
  VoxelScene voxels(32);
  voxels.add_cells(dust(20), {0, 0, 0}, 64);
  const FirstHitScene scene = build(voxels);
  for (const double away : {1e3, 1e5, 1e7}) {
    SCOPED_TRACE(away);
    std::vector<FirstHitRay> rays;
    const std::vector<FirstHitRay> through = random_rays(5000, 10, 54);
    for (FirstHitRay r : through) {
      for (std::size_t a = 0; a < 3; ++a) r.origin[a] -= away * double(r.direction[a]);
      rays.push_back(r);
    }
    EXPECT_GT(score(scene, dust(20), rays).met, 4000);
  }
}

TEST(FirstHit, StopsAtTheEndOfARay) {
  VoxelScene voxels(32);
  voxels.add_cells(dust(400), {0, 0, 0}, 64);
  const FirstHitScene scene = build(voxels);
  std::vector<FirstHitRay> rays = random_rays(5000, -20, 84);
  const std::vector<FirstHit> whole = cast(scene, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) rays[i].end = i % 2 == 0 ? whole[i].distance + 0.01f : 20;
  const std::vector<FirstHit> cut = cast(scene, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool expected = whole[i].attributes_index != kernels::no_attributes && whole[i].distance <= rays[i].end;
    EXPECT_EQ(cut[i].attributes_index, expected ? whole[i].attributes_index : kernels::no_attributes) << i;
  }
}

TEST(FirstHit, NamesTheColourAndNormalOfTheVoxelItMet) {
  VoxelScene voxels(32);
  voxels.add_cells(dust(20), {0, 0, 0}, 64);
  const FirstHitScene scene = build(voxels);
  for (const FirstHit& hit : cast(scene, random_rays(5000, -20, 84))) {
    if (hit.attributes_index == kernels::no_attributes) continue;
    const kernels::VoxelAttributes& voxel = scene.attributes[hit.attributes_index];
    std::int64_t v[3];
    for (std::size_t a = 0; a < 3; ++a) v[a] = scene.lattice_min[a] + std::int64_t(hit.voxel >> 21 * a & 0x1fffff);
    EXPECT_EQ(voxel.rgba, std::uint32_t(v[0] | v[1] << 8 | v[2] << 16 | 255 << 24));
    EXPECT_EQ(voxel.normal[0], v[0]);
    EXPECT_EQ(voxel.normal[1], v[1]);
  }
}

/// Solid ground makes constant nodes of all sizes. The cells' corners are not aligned to large nodes of the tree.
TEST(FirstHit, MeetsConstantNodes) {
  const Painter solid = [](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
    if (z < 8 || z >= 40 || x < 0 || x >= 128 || y < 0 || y >= 64) return {};
    return Paint{{1, 2, 3, 255}, {4, 5}};
  };
  VoxelScene voxels(64);
  voxels.add_cell(solid, {0, 0, 8});
  voxels.add_cell(solid, {64, 0, -16});
  const FirstHitScene scene = build(voxels);
  EXPECT_EQ(scene.voxels, 128u * 64 * 32);
  EXPECT_LT(scene.nodes.size(), 3000u);
  const std::vector<FirstHitRay> rays = random_rays(20000, -40, 120);
  EXPECT_GT(score(scene, solid, rays).met, 3000);
  for (const FirstHit& hit : cast(scene, rays))
    if (hit.attributes_index != kernels::no_attributes) {
      EXPECT_EQ(scene.attributes[hit.attributes_index].rgba, 0xff030201u);
    }
}

TEST(FirstHit, BeamsSkipNoVoxel) {
  VoxelScene voxels(64);
  voxels.add_cells(hills, {0, 0, 0}, 128);
  const FirstHitScene scene = build(voxels);
  const ThreadPool pool(2);
  std::set<int> tiles;
  for (const kernels::FirstHitCamera& c : cameras_on_hills()) {
    tiles.insert(kernels::plan_beams(scene.view, c).tile);
    std::vector<FirstHit> hits(std::size_t(c.width) * std::size_t(c.height));
    kernels::cast_first_hits(scene.view, c, {{hits.data(), hits.size()}, {}}, pool);
    std::vector<FirstHitRay> rays;
    for (int i = 0; i < c.width * c.height; ++i)
      rays.push_back(kernels::camera_ray(c, float(i % c.width) + 0.5f, float(i / c.width) + 0.5f));
    EXPECT_LT(score(scene, hills, rays, hits).close, 20);
  }
  EXPECT_EQ(tiles, (std::set<int>{0, 4, 8}));
}

TEST(FirstHit, AgreesInASceneOfMaxExtent) {
  const auto twice = [](std::int64_t x, std::int64_t y, std::int64_t z) { return dust(20)(x & 0x1ffff, y, z); };
  VoxelScene voxels(32);
  voxels.add_cells(twice, {0, 0, 0}, 64);
  voxels.add_cells(twice, {1 << 17, 0, 0}, 64);
  const FirstHitScene scene = build(voxels);
  EXPECT_EQ(scene.view.tree.bits, kernels::max_first_hit_bits);
  std::vector<FirstHitRay> rays = random_rays(300, 0, 64);
  for (std::size_t i = 0; i < rays.size(); i += 3)
    rays[i] = ray({100, rays[i].origin[1], rays[i].origin[2]}, {1, 0.0002 * double(rays[i].direction[1]), 1e-6});
  const Score s = score(scene, twice, rays);
  EXPECT_GT(s.met, 200);
  EXPECT_GT(s.same, 240);
}

TEST(FirstHit, RefusesAWiderScene) {
  FirstHitBuilder builder(0);
  VoxelScene voxels(32);
  voxels.add_cells(dust(20), {0, 0, 0}, 64);
  builder.add_cell({0, 0, 0}, voxels.shards()[0].nodes, voxels.shards()[0].levels[0]);
  builder.add_cell({(1 << 18) - 32, 0, 0}, voxels.shards()[0].nodes, voxels.shards()[0].levels[0]);
  EXPECT_THROW(builder.finish(), std::length_error);
}

TEST(FirstHit, RefusesCellsThatNoTreeOfTheLodHolds) {
  FirstHitBuilder builder(2);
  VoxelScene voxels(64);
  voxels.add_cell(dust(20), {0, 0, 0});
  builder.add_cell({0, 0, 0}, voxels.shards()[0].nodes, voxels.shards()[0].levels[2]);
  EXPECT_THROW(builder.add_cell({64, 0, 8}, voxels.shards()[0].nodes, voxels.shards()[0].levels[2]),
               std::invalid_argument);
}

/// The reference derives level 1 from level 0: a voxel exists if one of its eight lod-0 voxels exists.
TEST(FirstHit, MeetsTheVoxelsOfACoarserLod) {
  VoxelScene voxels(32);
  voxels.add_cells(dust(300), {0, 0, 0}, 64);
  const FirstHitScene scene = build(voxels, 1);
  const auto coarse = [&](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
    for (int i = 0; i < 8; ++i)
      if (dust(300)(2 * x + (i & 1), 2 * y + (i >> 1 & 1), 2 * z + (i >> 2))) return Paint{};
    return {};
  };
  const std::vector<FirstHitRay> rays = random_rays(5000, -20, 84);
  const std::vector<FirstHit> hits = cast(scene, rays);
  int met = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    met += hits[i].attributes_index != kernels::no_attributes;
    EXPECT_NE(bench::compare(scene.view.tree, rays[i], hits[i], rounding_of(scene),
                             [&](const bench::Voxel& v) {
                               return coarse(scene.lattice_min[0] / 2 + v[0], scene.lattice_min[1] / 2 + v[1],
                                             scene.lattice_min[2] / 2 + v[2])
                                   .has_value();
                             }),
              Agreement::wrong);
  }
  EXPECT_GT(met, 500);
}

TEST(FirstHit, AnEmptySceneIsNotMet) {
  const FirstHitScene scene = FirstHitBuilder(0).finish();
  for (const FirstHit& hit : cast(scene, random_rays(10, -1, 1)))
    EXPECT_EQ(hit.attributes_index, kernels::no_attributes);
}

}  // namespace
}  // namespace gigabake
