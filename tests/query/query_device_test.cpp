// Rays that pause at trees that are not resident, and rays on a device, give the CPU's answers bit for bit.
#include "query/query_device.h"

#include <gtest/gtest.h>
#include <map>
#include <random>

#include "kernels/cuda/baker.h"
#include "tests/query/stored_dust.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using namespace query_test;
using kernels::QueryCells;

/// Returns random rays and special ones: through faces, edges and corners of cells and voxels, from inside voxels, and
/// past the scene. Others are almost parallel to an axis, or search a short or empty interval.
std::vector<QueryRay> rays_of_all_kinds(std::mt19937_64& rng, std::size_t random) {
  std::vector<QueryRay> rays = random_query_rays(rng, random);
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        for (const double at : {-16.0, 0.0, 0.5, 13.0, 31.5, 32.0, 64.0, 80.0, 1e9})
          rays.push_back(query_ray({32 + at * x, 32 + at * y, 32 - at * z}, {double(x), double(y), double(z)}));
        rays.push_back(query_ray({5.5, 6.5, 7.5}, {x + 1e-12, y - 1e-300, z + 1e-17}));
      }
  for (std::size_t i = 0; i < random; i += 7) {
    QueryRay limited = rays[i];
    limited.begin = double(i % 50);
    limited.end = limited.begin + double(i % 3) * 10;
    rays.push_back(limited);
  }
  if (rays.size() % 2 == 0) rays.pop_back();
  return rays;
}

void expect_equal(const std::vector<QueryHit>& got, const std::vector<QueryHit>& expected, std::uint64_t seed) {
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i) {
    const QueryHit &g = got[i], &e = expected[i];
    const auto values = [](const QueryHit& h) {
      return std::tuple(h.outcome, h.lod, h.distance, h.voxel[0], h.voxel[1], h.voxel[2], h.rgba, h.normal[0],
                        h.normal[1], h.shard);
    };
    ASSERT_EQ(values(g), values(e)) << "ray " << i << ", seed " << seed;
  }
}

/// Runs the device's traversal on the host. Only the trees of every second cell are resident.
TEST(QueryCells, PausedTraversalsResumeToTheSameAnswers) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const ThreadPool pool(2);
  const StoredDust stored(dust_cells([](auto x, auto y, auto z) { return is_dust(x, y, z, 200); }));
  const std::shared_ptr<const PagedScene> scene = stored.open();
  NumberedShards numbers(scene, {});
  QueryPlaces places(numbers, 1 << 20, pool);
  places.lay_out_all(pool);
  std::vector<QueryCells::Entry> entries;
  QueryCells cells = query_cells(places, entries);
  std::map<std::uint32_t, QueryTree> built;
  std::vector<kernels::ShardTree> trees(entries.size());
  for (std::size_t c = 0; c < entries.size(); ++c) {
    if (entries[c].state == QueryCells::State::none) continue;
    built.emplace(std::uint32_t(c), QueryTreeSource(*scene, numbers.shard(entries[c].shard), 0));
    trees[c] = built.at(std::uint32_t(c)).view();
    if (c % 2 == 0) entries[c].state = QueryCells::State::resident;
  }
  cells.trees = {trees.data(), trees.size()};
  const std::vector<QueryRay> rays = rays_of_all_kinds(rng, 5001);
  const QueryLevels levels{0, 0, places.lods()};
  std::vector<QueryHit> got;
  std::uint32_t slots[kernels::first_hit_stack];
  const kernels::FirstHitSlots<1> stack{slots};
  std::size_t paused = 0;
  for (const QueryRay& ray : rays) {
    QueryTraversal walk = kernels::start_march(ray, levels, places.window());
    while (!kernels::advance_walk(ray, levels, cells, stack, walk)) {
      ++paused;
      std::vector<QueryCells::Entry> all = entries;
      for (QueryCells::Entry& entry : all)
        if (entry.state == QueryCells::State::absent) entry.state = QueryCells::State::resident;
      QueryCells complete = cells;
      complete.entries = {all.data(), all.size()};
      ASSERT_TRUE(kernels::advance_walk(ray, levels, complete, stack, walk));
    }
    got.push_back(walk.nearest);
  }
  EXPECT_GT(paused, 500u);
  SceneQuery query(scene, {}, pool);
  expect_equal(got, answers_of(query, rays), seed);
}

class CudaSceneQuery : public testing::Test {
 protected:
  void SetUp() override {
    const kernels::CudaDevices devices = kernels::cuda_devices();
    if (devices.usable.empty()) GTEST_SKIP() << devices.reason;
    options_.device = [device = devices.usable[0]] { return device; };
    options_.min_device_rays = 1;
  }
  QueryOptions options_;
  ThreadPool pool_{2};
};

TEST_F(CudaSceneQuery, AnswersAsTheCpuDoes) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (const std::uint64_t sparsity : {3u, 200u, 20000u}) {
    const StoredDust stored(dust_cells([&](auto x, auto y, auto z) { return is_dust(x, y, z, sparsity); }));
    for (const int lod : {0, 1}) {
      options_.lod = lod;
      SceneQuery on_cpu(stored.open(), {.lod = lod}, pool_), on_device(stored.open(), options_, pool_);
      for (const std::size_t count : {1u, 33u, 5001u, 300001u}) {
        const std::vector<QueryRay> rays = rays_of_all_kinds(rng, count);
        const std::vector<QueryHit> expected = answers_of(on_cpu, rays);
        for (int batch = 0; batch < 4; ++batch) expect_equal(answers_of(on_device, rays), expected, seed);
      }
      EXPECT_GT(on_device.counts().device_rays, 300001u);
      EXPECT_EQ(on_device.device_problem(), "");
    }
  }
}

TEST_F(CudaSceneQuery, AnswersAsTheCpuDoesIfCellsDoNotFitOrAreMissing) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  StoredDust stored(dust_cells([](auto x, auto y, auto z) { return is_dust(x, y, z, 20); }));
  std::erase_if(stored.description.cells, [](const SceneCell& c) { return c.name == "c_1_1_0"; });
  stored.description.losses.push_back({"cell c_1_1_0", "was not baked"});
  std::filesystem::remove(stored.folder.path() / stored.description.cells[2].file);
  const std::vector<QueryRay> rays = rays_of_all_kinds(rng, 20001);
  SceneQuery on_cpu(stored.open(), {}, pool_);
  const std::vector<QueryHit> expected = answers_of(on_cpu, rays);
  constexpr std::uint64_t ray_bytes = (std::uint64_t(1) << 18) * (sizeof(QueryRay) + sizeof(QueryTraversal));
  for (const std::uint64_t bytes : {std::uint64_t(1000), ray_bytes + 100000, std::uint64_t(1) << 30}) {
    options_.device_bytes = bytes;
    SceneQuery on_device(stored.open(), options_, pool_);
    for (int batch = 0; batch < 3; ++batch) expect_equal(answers_of(on_device, rays), expected, seed);
    EXPECT_EQ(on_device.device_problem().empty(), bytes > ray_bytes * 2);
  }
}

}  // namespace
}  // namespace gigabake
