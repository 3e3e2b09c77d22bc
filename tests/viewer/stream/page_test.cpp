#include "viewer/stream/page.h"

#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <thread>

#include "core/base/error.h"
#include "core/octree/parameters.h"
#include "tests/format/shard/made_shard.h"
#include "tests/random_seed.h"
#include "viewer/stream/open_shards.h"
#include "viewer/stream/pager.h"
#include "viewer/stream/shard_map.h"

namespace gigabake {
namespace {

using made::TempFolder;
using testing::HasSubstr;

/// Returns adjacent cells with random content.
std::vector<Shard> cells(std::mt19937_64& rng, int count) {
  std::vector<Shard> shards;
  for (int i = 0; i < count; ++i) {
    Shard s = made::random_shard(rng, {3, true, 5});
    s.header.cell = "c_" + std::to_string(i);
    s.header.lattice_min = {32 * i, 0, 0};
    s.header.origin = {};
    shards.push_back(made::with_content_hash(std::move(s)));
  }
  return shards;
}

std::shared_ptr<const PagedScene> opened(const TempFolder& folder, const SceneDescription& scene) {
  return std::make_shared<const PagedScene>(PagedScene::of_cells(folder / "scene.xml", scene));
}

PageSource pages_of(const TempFolder& folder, const SceneDescription& scene) {
  return pages_from_files(opened(folder, scene));
}

std::string refusal_of(const PageSource& source, const PageKey& key) {
  try {
    source(key);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(PagesFromFiles, AreThoseOfTheCellThatTheKeySays) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  const std::vector<Shard> shards = cells(rng, 4);
  const SceneDescription scene = made::write_scene_of(folder / "scene.xml", shards);
  const PageSource source = pages_of(folder, scene);
  for (std::uint32_t cell = 0; cell < 4; ++cell) {
    const Shard& shard = shards[cell];
    const Page nodes = source({cell, -1, 0});
    EXPECT_EQ(nodes.rows.size(), shard.nodes.key.size());
    EXPECT_EQ(nodes.rows[0].value, shard.nodes.value[0]);
    EXPECT_TRUE(nodes.bricks.mask.empty());
    EXPECT_GE(nodes.bytes(), nodes.rows.size() * 12);
    for (int lod = 0; lod < 3; ++lod) {
      const BrickLevel& level = shard.levels[std::size_t(lod)];
      if (level.mask.empty()) continue;
      const Page bricks = source({cell, lod, 0});
      EXPECT_TRUE(bricks.rows.empty());
      EXPECT_EQ(bricks.bricks.mask, level.mask);
      EXPECT_EQ(bricks.bricks.rgba, level.rgba);
      EXPECT_EQ(bricks.bricks.normal, level.normal);
    }
  }
}

TEST(PagesFromFiles, SayWhichPartThereIsNot) {
  std::mt19937_64 rng(1);
  const TempFolder folder;
  const SceneDescription scene = made::write_scene_of(folder / "scene.xml", cells(rng, 2));
  const PageSource source = pages_of(folder, scene);
  EXPECT_THAT(refusal_of(source, {2, -1, 0}), HasSubstr("scene.xml: shard 2: the scene has 2 cells and 0 overviews"));
  EXPECT_THAT(refusal_of(source, {0, 3, 0}), HasSubstr("c_0.h5: /lod_3: the cell has no such level"));
  EXPECT_THAT(refusal_of(source, {0, 0, 0xffffffffu}), HasSubstr("was requested"));
  EXPECT_THAT(refusal_of(source, {0, -1, 0xffffffffu}), HasSubstr("was requested"));
}

TEST(PagesFromFiles, RefuseAShardThatIsNotTheScenes) {
  std::mt19937_64 rng(2);
  const TempFolder folder;
  const SceneDescription scene = made::write_scene_of(folder / "scene.xml", cells(rng, 2));
  SceneDescription other = scene;
  other.cells[0].fingerprint = {7, 7};
  other.cells[1].lattice_min[0] += 8;
  const PageSource source = pages_of(folder, other);
  EXPECT_THAT(refusal_of(source, {0, -1, 0}), HasSubstr("c_0.h5: fingerprint: differs from scene.xml"));
  EXPECT_THAT(refusal_of(source, {1, 0, 0}), HasSubstr("c_1.h5: lattice_min: is of another window"));
}

TEST(PagesFromFiles, DoNotStopWhereAFileIsMissingOrDamaged) {
  std::mt19937_64 rng(3);
  const TempFolder folder;
  const SceneDescription scene = made::write_scene_of(folder / "scene.xml", cells(rng, 4));
  std::filesystem::remove(folder / "shards" / "c_1.h5");
  std::ofstream(folder / "shards" / "c_2.h5") << "not a shard";
  Pager pager(pages_of(folder, scene), {2, UINT64_MAX});
  std::vector<PageKey> keys;
  for (std::uint32_t cell = 0; cell < 4; ++cell)
    for (int lod = -1; lod < 3; ++lod) keys.push_back({cell, lod, 0});
  pager.request(keys);
  do {
    pager.wait();
    pager.begin_pass();
  } while (pager.counts().queued > 0);
  pager.begin_pass();
  for (const std::uint32_t cell : {0u, 3u}) EXPECT_NE(pager.find({cell, -1, 0}), nullptr);
  for (const std::uint32_t cell : {1u, 2u})
    for (int lod = -1; lod < 3; ++lod) EXPECT_TRUE(pager.is_damaged({cell, lod, 0}));
  std::size_t of_missing = 0, of_damaged = 0;
  for (const std::string& problem : pager.problems()) {
    of_missing += problem.find("c_1.h5: no such file") != std::string::npos;
    of_damaged += problem.find("c_2.h5: H5Fopen failed") != std::string::npos;
  }
  EXPECT_EQ(of_missing, 1u);
  EXPECT_EQ(of_damaged, 1u);
}

// 2026-11-25: up to 400 shards were open under any memory limit, and their memory was not counted.
TEST(OpenShards, AreAsManyAsAnEighthOfTheMemoryHolds) {
  EXPECT_EQ(open_shards_within(std::uint64_t(64) << 20), 25u);
  EXPECT_EQ(open_shards_within(std::uint64_t(4) << 30), max_open_shards);
  EXPECT_EQ(open_shards_within(0), 4u);
  for (std::uint64_t bytes = std::uint64_t(16) << 20; bytes < std::uint64_t(4) << 30; bytes *= 2)
    EXPECT_LE(open_shards_within(bytes) * open_shard_bytes, bytes / 8);
}

TEST(OpenShards, CloseTheLeastRecentlyUsedAndOpenItAgainOnRequest) {
  std::mt19937_64 rng(4);
  const TempFolder folder;
  const SceneDescription scene = made::write_scene_of(folder / "scene.xml", cells(rng, 3));
  NumberedShards numbers(opened(folder, scene), {});
  OpenShards shards(numbers, 2);
  const std::weak_ptr<const ShardPages> first = shards.get(0), second = shards.get(1);
  EXPECT_EQ(shards.get(0), first.lock());
  shards.get(2);
  EXPECT_FALSE(first.expired());
  EXPECT_TRUE(second.expired());
  EXPECT_EQ(shards.get(1)->header().cell, "c_1");
  EXPECT_TRUE(first.expired());
}

TEST(OpenShards, StayOpenForWhoHoldsThem) {
  std::mt19937_64 rng(5);
  const TempFolder folder;
  const std::vector<Shard> written = cells(rng, 2);
  const SceneDescription scene = made::write_scene_of(folder / "scene.xml", written);
  NumberedShards numbers(opened(folder, scene), {});
  OpenShards shards(numbers, 1);
  const auto held = shards.get(0);
  shards.get(1);
  std::filesystem::remove(folder / "shards" / "c_0.h5");
  EXPECT_EQ(held->nodes(0, 4096).size(), written[0].nodes.key.size());
  EXPECT_THROW(shards.get(0), InputError);
}

TEST(OpenShards, AreReadByManyThreadsThoughFewAreOpen) {
  std::mt19937_64 rng(6);
  const TempFolder folder;
  const std::vector<Shard> written = cells(rng, 5);
  const SceneDescription scene = made::write_scene_of(folder / "scene.xml", written);
  NumberedShards numbers(opened(folder, scene), {});
  OpenShards shards(numbers, 2);
  std::vector<std::jthread> readers;
  for (std::uint64_t t = 0; t < 4; ++t)
    readers.emplace_back([&, t] {
      std::mt19937_64 own(t);
      for (int i = 0; i < 100; ++i) {
        const auto cell = std::uint32_t(own() % 5);
        const auto shard = shards.get(cell);
        EXPECT_EQ(shard->header().cell, "c_" + std::to_string(cell));
        EXPECT_EQ(shard->nodes(0, 4096).size(), written[cell].nodes.key.size());
      }
    });
}

/// Returns a row of cells of 16 voxels, with overviews of 64 and 256 voxels and a root of 1024 voxels.
SceneDescription row_of_overviews() {
  SceneDescription scene;
  scene.voxel_size_m = 1;
  scene.parameters = to_json(BakeParameters{.voxel_size_m = 1, .cell_voxels = 16});
  const auto add = [](std::vector<SceneCell>& to, std::int64_t x, std::uint32_t edge, std::uint32_t first_lod) {
    SceneCell shard;
    shard.name = (first_lod == 0 ? "c_" : "p_") + std::to_string(first_lod) + "_" + std::to_string(x);
    shard.file = "shards/" + shard.name + ".h5";
    shard.lattice_min = {x, 0, 0};
    shard.cell_voxels = edge;
    shard.first_lod = first_lod;
    shard.lods = 2;
    shard.voxels = {1, 1};
    shard.content_hash = {{1, 2}, {3, 4}};
    to.push_back(shard);
  };
  for (std::int64_t x = 0; x < 512; x += 16) add(scene.cells, x, 16, 0);
  for (std::int64_t x = 0; x < 512; x += 64) add(scene.overviews, x, 64, 2);
  for (std::int64_t x = 0; x < 512; x += 256) add(scene.overviews, x, 256, 4);
  add(scene.overviews, 0, 1024, 6);
  return scene;
}

TEST(NumberedShards, CountCellsThenOverviewsPageByPage) {
  const TempFolder folder;
  write_scene(folder / "scene.xml", row_of_overviews(), {4, 8, 2});
  const auto scene = std::make_shared<const PagedScene>(folder / "scene.xml");
  ASSERT_EQ(scene->root().overviews.size(), 1u) << "the root only; overviews of 64 and 256 voxels are in pages";
  NumberedShards numbers(scene, {});
  std::uint32_t number = 0;
  scene->for_each_cell([&](const SceneCell& cell) { EXPECT_EQ(numbers.shard(number++).name, cell.name); });
  scene->for_each_overview([&](const SceneCell& overview) { EXPECT_EQ(numbers.shard(number++).name, overview.name); });
  EXPECT_EQ(number, 32u + 11u);
  EXPECT_THROW(numbers.shard(number), InputError);
  const ShardMap map(*scene, overview_levels(*scene).value());
  Pager pager(pages_from_files(scene), {1, UINT64_MAX});
  for (std::int64_t x = 0; x < 512; x += 48)
    for (const int lod : {2, 4, 6}) {
      std::optional<ShardExtent> found;
      for (int round = 0; round < 4; ++round) {
        MissingPages missing_pages;
        kernels::VoxelBox empty;
        const Vec3i64 v{x, 5, 5};
        found = map.find(lod, 0, v, pager, missing_pages, empty);
        if (missing_pages.missing.empty()) break;
        pager.request(missing_pages.missing);
        pager.wait();
        pager.begin_pass();
      }
      ASSERT_TRUE(found.has_value());
      const std::int64_t edge = std::int64_t(16) << lod;
      EXPECT_EQ(numbers.shard(found->number).name, "p_" + std::to_string(lod) + "_" + std::to_string(x / edge * edge));
    }
}

}  // namespace
}  // namespace gigabake
