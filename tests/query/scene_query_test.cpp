// First hits of a paged scene, compared with a traversal in double precision, and queries as text.
#include "query/scene_query.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>
#include <set>

#include "bench/first_hit/first_hit_reference.h"
#include "core/base/error.h"
#include "query/query_job.h"
#include "tests/query/stored_dust.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using testing::HasSubstr;
using namespace query_test;

/// Compares a hit with the reference, whose rays are relative to a cube of 64 voxels.
template <class Exists>
bench::Agreement agreement_of(const QueryRay& ray, const QueryHit& hit, const Exists& exists) {
  kernels::FirstHitTree cube;
  for (double& c : cube.centre) c = dust_edge / 2.0;
  cube.edge = dust_edge;
  cube.per_edge = 1.0 / dust_edge;
  cube.bits = 6;
  kernels::FirstHitRay single;
  kernels::FirstHit found;
  for (int a = 0; a < 3; ++a) {
    single.origin[a] = ray.origin[a];
    single.direction[a] = float(ray.direction[a]);
    found.voxel |= std::uint64_t(hit.voxel[a]) << 21 * a;
  }
  const bool met = hit.outcome == QueryOutcome::hit;
  found.attributes_index = met ? 0 : kernels::no_attributes;
  if (met) found.distance = float(hit.distance);
  return bench::compare(cube, single, found, 1e-3, [&](const bench::Voxel& v) { return exists(v[0], v[1], v[2]); });
}

TEST(SceneQuery, AgreesWithTheReferenceAcrossCells) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const ThreadPool pool(2);
  for (const std::uint64_t sparsity : {20u, 2000u}) {
    const auto exists = [&](auto x, auto y, auto z) { return is_dust(x, y, z, sparsity); };
    const StoredDust stored(dust_cells(exists));
    SceneQuery query(stored.open(), {}, pool);
    const std::vector<QueryRay> rays = random_query_rays(rng, 20000);
    const std::vector<QueryHit> hits = answers_of(query, rays);
    int met = 0, close = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bench::Agreement a = agreement_of(rays[i], hits[i], exists);
      ASSERT_NE(a, bench::Agreement::wrong) << "ray " << i << ", " << seed;
      close += a == bench::Agreement::within_rounding ? 1 : 0;
      if (hits[i].outcome != QueryOutcome::hit) continue;
      ++met;
      for (int c = 0; c < 3; ++c) EXPECT_EQ(hits[i].rgba >> 8 * c & 255, std::uint32_t(hits[i].voxel[c]));
    }
    EXPECT_GT(met, 100);
    EXPECT_LT(close, 60) << seed;
  }
}

TEST(SceneQuery, ALittleMemoryGivesTheSameAnswers) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const StoredDust stored(dust_cells([](auto x, auto y, auto z) { return is_dust(x, y, z, 20); }));
  const std::vector<QueryRay> rays = random_query_rays(rng, 3000);
  const ThreadPool one(1), two(2);
  SceneQuery all(stored.open(), {}, two), little(stored.open(), {0, 0, 200000}, one);
  const std::vector<QueryHit> expected = answers_of(all, rays), got = answers_of(little, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(got[i].outcome, expected[i].outcome);
    EXPECT_EQ(got[i].distance, expected[i].distance);
    EXPECT_EQ(got[i].rgba, expected[i].rgba);
  }
  EXPECT_EQ(all.counts().trees_built, 8u);
  EXPECT_GT(little.counts().trees_built, 8u) << "the memory held all trees: the test shows nothing";
  EXPECT_LE(little.counts().peak_bytes, 200000u);
  SceneQuery none(stored.open(), {0, 0, 1000}, one);
  EXPECT_THROW(answers_of(none, rays), UsageError);
}

/// Wall through all cells, one voxel thick; its voxels share only edges.
TEST(SceneQuery, NoRaySlipsThroughAWallBetweenCells) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const StoredDust stored(dust_cells([](auto x, auto y, auto) { return x + y == dust_edge - 1; }));
  const ThreadPool pool(2);
  SceneQuery query(stored.open(), {}, pool);
  std::uniform_real_distribution<double> tiny(-1e-4, 1e-4), height(20, 44), away(5, 2000), up(-0.1, 0.1);
  std::uniform_int_distribution<int> edge(8, 55), place(0, 1);
  std::vector<QueryRay> rays;
  for (int i = 0; i < 20000; ++i) {
    const double x = place(rng) != 0 ? dust_cell_edge : edge(rng), far = away(rng), rise = up(rng) / far;
    const double slope = 1 + tiny(rng) / far;
    rays.push_back(query_ray({x - far, dust_edge - x - far * slope, height(rng) - far * rise}, {1, slope, rise}));
  }
  for (const QueryHit& hit : answers_of(query, rays)) ASSERT_EQ(hit.outcome, QueryOutcome::hit) << seed;
}

/// Rays run along the faces between cells, within the rounding error of the faces, towards a wall on both sides.
TEST(SceneQuery, NoRayGetsLostBetweenTwoCells) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const StoredDust stored(dust_cells([](auto x, auto, auto) { return x == 60; }));
  const ThreadPool pool(2);
  SceneQuery query(stored.open(), {}, pool);
  std::uniform_real_distribution<double> tiny(-1e-5, 1e-5), along(1, 63);
  std::vector<QueryRay> rays;
  for (int i = 0; i < 10000; ++i) {
    const double z = i % 2 == 0 ? dust_cell_edge + tiny(rng) : along(rng);
    rays.push_back(query_ray({-5, dust_cell_edge + tiny(rng), z}, {1, tiny(rng), tiny(rng) / 10}));
  }
  for (const double y : {0.0, 1.0, 32.0, 63.0}) rays.push_back(query_ray({-5, y, 32}, {1, 0, 0}));
  for (const QueryHit& hit : answers_of(query, rays)) {
    ASSERT_EQ(hit.outcome, QueryOutcome::hit) << seed;
    EXPECT_EQ(hit.voxel[0], 60);
  }
}

TEST(SceneQuery, TellsNothingOutsideAndInsideApart) {
  const StoredDust stored(
      dust_cells([](auto x, auto y, auto z) { return x + y + z == 0 || (x == 40 && y == 40 && z == 40); }));
  const ThreadPool pool(1);
  SceneQuery query(stored.open(), {}, pool);
  QueryRay early = query_ray({40.5, 40.5, 60}, {0, 0, -1}), behind = early;
  early.end = 18;
  behind.begin = 19.5;
  const std::vector<QueryHit> hits =
      answers_of(query, {query_ray({40.5, 40.5, 60}, {0, 0, -1}), query_ray({5, 5, 60}, {0, 0, -1}),
                         query_ray({5, 5, 100}, {0, 0, 1}), query_ray({40.5, 40.5, 40.5}, {1, 0, 0}), early, behind,
                         query_ray({1e9, 40.5, 40.5}, {-1, 0, 0})});
  EXPECT_EQ(hits[0].outcome, QueryOutcome::hit);
  EXPECT_EQ(hits[0].distance, 19);
  EXPECT_EQ(hits[1].outcome, QueryOutcome::nothing);
  EXPECT_EQ(hits[2].outcome, QueryOutcome::outside);
  EXPECT_EQ(hits[3].outcome, QueryOutcome::hit);
  EXPECT_EQ(hits[3].distance, 0);
  EXPECT_EQ(hits[4].outcome, QueryOutcome::nothing);
  EXPECT_EQ(hits[5].outcome, QueryOutcome::hit) << "it begins in the voxel";
  EXPECT_EQ(hits[5].distance, 19.5);
  EXPECT_EQ(hits[6].distance, 1e9 - 41);
}

TEST(SceneQuery, SaysWhereACellIsMissing) {
  const auto exists = [](auto x, auto, auto z) { return z == 10 || (z == 50 && x < 40); };
  const ThreadPool pool(2);
  const QueryRay down = query_ray({50.5, 50.5, 90}, {0, 0, -1}), stopped = query_ray({34.5, 50.5, 90}, {0, 0, -1});
  {
    StoredDust lost(dust_cells(exists));
    std::erase_if(lost.description.cells, [](const SceneCell& c) { return c.name == "c_1_1_0"; });
    lost.description.losses.push_back({"cell c_1_1_0", "was not baked"});
    SceneQuery query(lost.open(), {}, pool);
    const std::vector<QueryHit> hits = answers_of(query, {down, stopped, query_ray({5, 5, 90}, {0, 0, -1})});
    EXPECT_EQ(hits[0].outcome, QueryOutcome::missing);
    EXPECT_EQ(hits[0].distance, 90 - 32);
    EXPECT_EQ(query.name_of(hits[0].shard), "c_1_1_0");
    EXPECT_EQ(hits[1].outcome, QueryOutcome::hit) << "met before the ray came there";
    EXPECT_EQ(hits[2].outcome, QueryOutcome::hit);
  }
  {
    StoredDust lost(dust_cells(exists));
    std::erase_if(lost.description.cells, [](const SceneCell& c) { return c.name.starts_with("c_1_1_"); });
    lost.description.losses.push_back({"cell c_1_1_0", "was not baked"});
    SceneQuery query(lost.open(), {}, pool);
    EXPECT_EQ(answers_of(query, {down})[0].outcome, QueryOutcome::missing) << "a column of which nothing is left";
  }
  {
    const StoredDust damaged(dust_cells(exists));
    std::ofstream(damaged.folder.path() / damaged.description.cells[3].file, std::ios::trunc) << "no shard";
    std::filesystem::remove(damaged.folder.path() / damaged.description.cells[0].file);
    SceneQuery query(damaged.open(), {}, pool);
    const std::vector<QueryHit> hits = answers_of(query, {down, query_ray({5, 5, 20}, {0, 0, -1})});
    EXPECT_EQ(hits[0].outcome, QueryOutcome::missing);
    EXPECT_EQ(hits[1].outcome, QueryOutcome::missing);
    EXPECT_EQ(query.problems().size(), 2u);
  }
}

TEST(SceneQuery, MeetsCoarserVoxelsAsItsFootprintGrows) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const auto fine = [](auto x, auto y, auto z) { return is_dust(x, y, z, 300); };
  const auto exists = [&](int lod, std::int64_t x, std::int64_t y, std::int64_t z) {
    for (std::int64_t i = 0; i < std::int64_t(1) << 3 * lod; ++i) {
      const std::int64_t mask = (1 << lod) - 1;
      if (fine((x << lod) + (i & mask), (y << lod) + (i >> lod & mask), (z << lod) + (i >> 2 * lod))) return true;
    }
    return false;
  };
  const StoredDust stored(dust_cells(fine));
  const ThreadPool pool(2);
  constexpr double spread = 0.05;
  SceneQuery growing(stored.open(), {0, spread, 1u << 30}, pool);
  const std::vector<QueryRay> rays = random_query_rays(rng, 4000);
  const std::vector<QueryHit> hits = answers_of(growing, rays);
  std::set<int> levels;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (hits[i].outcome != QueryOutcome::hit) continue;
    const QueryHit& hit = hits[i];
    levels.insert(hit.lod);
    // 2^lod is the max voxel width within the footprint, limited to the three levels of the cells.
    const double footprint = spread * hit.distance, width = std::exp2(hit.lod);
    EXPECT_TRUE(hit.lod == 0 || width <= footprint * (1 + 1e-9)) << seed;
    EXPECT_TRUE(hit.lod == 2 || 2 * width >= footprint * (1 - 1e-9)) << seed;
    EXPECT_TRUE(exists(hit.lod, hit.voxel[0] >> hit.lod, hit.voxel[1] >> hit.lod, hit.voxel[2] >> hit.lod)) << seed;
  }
  EXPECT_EQ(levels, (std::set<int>{0, 1, 2}));
  SceneQuery finest(stored.open(), {}, pool);
  const std::vector<QueryHit> exact = answers_of(finest, rays);
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (exact[i].outcome == QueryOutcome::hit) {
      EXPECT_EQ(hits[i].outcome, QueryOutcome::hit) << "coarser voxels hold the finer ones; " << seed;
      EXPECT_LE(hits[i].distance, exact[i].distance + 1e-6) << seed;
    }
  EXPECT_THROW(SceneQuery(stored.open(), {3, 0, 1u << 30}, pool), UsageError);
  EXPECT_THROW(SceneQuery(stored.open(), {0, std::nan(""), 1u << 30}, pool), UsageError);
}

std::string text_of(const StoredDust& stored, QueryJob job, const std::string& table, std::size_t at_a_time = 1000) {
  const ThreadPool pool(2);
  std::ofstream(stored.folder / "asked.csv", std::ios::binary) << table;
  SceneQuery query(stored.open(), {}, pool);
  job.batch_rays = at_a_time;
  const auto inputs = table_queries(stored.folder / "asked.csv", job.kind, job.frame, pool);
  std::string text;
  run_query(job, query, *inputs, pool, [&](std::string_view piece) { text += piece; });
  return text;
}

std::string refusal_of(const StoredDust& stored, const QueryJob& job, const std::string& table) {
  try {
    text_of(stored, job, table);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(QueryTable, RefusesWhatIsNoTableAndSaysWhere) {
  const StoredDust stored(dust_cells([](auto, auto, auto z) { return z == 3; }));
  const QueryJob rays, heights{.kind = QueryKind::height}, sights{.kind = QueryKind::sight};
  const std::string head = "x,y,z,dx,dy,dz\n";
  EXPECT_THAT(refusal_of(stored, rays, ""), HasSubstr("empty"));
  EXPECT_THAT(refusal_of(stored, rays, "1,2,3,4,5,6\n"), HasSubstr("line 1"));
  EXPECT_THAT(refusal_of(stored, rays, head + "0,0,9,0,0,-1\n\n0,0,9,0,0,nan\n"), HasSubstr("line 4: dz"));
  EXPECT_THAT(refusal_of(stored, rays, head + "0,0,9,0,0,-1\r\n0,0,9,0,0,0\r\n"), HasSubstr("line 3: the direction"));
  EXPECT_THAT(refusal_of(stored, rays, head + "0,0,9,0,0\n"), HasSubstr("line 2: expected 6 fields"));
  EXPECT_THAT(refusal_of(stored, rays, head + "0,0,1e300,0,0,1\n"), HasSubstr("line 2: expected numbers within"));
  EXPECT_THAT(refusal_of(stored, rays, head + "0,0,9,0,0,\"1\n"), HasSubstr("line 2: a quote"));
  EXPECT_THAT(refusal_of(stored, rays, head + "0,0,9,0,0,1x\n"), HasSubstr("got '1x'"));
  EXPECT_THAT(refusal_of(stored, rays, head + std::string(100000, '1')), HasSubstr("line 2: longer"));
  EXPECT_THAT(refusal_of(stored, rays, "x,y,z,dx,dy\n"), HasSubstr("expected the columns"));
  EXPECT_THAT(refusal_of(stored, rays, "x,y,z,dx,dy,dz,azimuth\n"), HasSubstr("expected the columns"));
  EXPECT_THAT(refusal_of(stored, rays, "x,x,y,z,dx,dy,dz\n"), HasSubstr("two columns"));
  EXPECT_THAT(refusal_of(stored, rays, "lon,lat,height,azimuth,elevation\n"), HasSubstr("no column is called"));
  EXPECT_THAT(refusal_of(stored, heights, "x,y,z\n"), HasSubstr("no column is called"));
  EXPECT_THAT(refusal_of(stored, sights, "x,y,z,to_x,to_y,to_z\n1,1,1,1,1,1\n"), HasSubstr("both points are the same"));
  EXPECT_THAT(refusal_of(stored, {.kind = QueryKind::ray, .format = QueryFormat::geojson}, head),
              HasSubstr("no position on the earth"));
}

TEST(QueryText, SaysTheSameForEveryNumberOfRaysAtATime) {
  const StoredDust stored(dust_cells([](auto x, auto y, auto z) { return is_dust(x, y, z, 30); }));
  std::string table = "\xef\xbb\xbfid,azimuth,elevation,x,y,z\r\n";
  for (int i = 0; i < 500; ++i)
    table += "\"a, \"\"" + std::to_string(i) + "\"\"\"," + std::to_string(i) + "," + std::to_string(i % 180 - 90) +
             ",+5,9,13\n";
  table.pop_back();  // the last line may lack its line end
  for (const QueryFormat format : values_of<QueryFormat>()) {
    if (format == QueryFormat::geojson || format == QueryFormat::npy) continue;
    const QueryJob job{.format = format};
    const std::string all = text_of(stored, job, table);
    EXPECT_EQ(text_of(stored, job, table, 7), all);
    EXPECT_THAT(all, HasSubstr(format == QueryFormat::csv ? "\"a, \"\"499\"\"\"," : "\"id\":\"a, \\\"499\\\"\""));
  }
}

}  // namespace
}  // namespace gigabake
