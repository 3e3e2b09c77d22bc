#include "viewer/stream/shard_map.h"

#include <gtest/gtest.h>
#include <map>
#include <random>
#include <set>

#include "core/octree/parameters.h"
#include "tests/format/shard/made_shard.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using kernels::VoxelBox;
using made::TempFolder;

constexpr std::int64_t tier_cell_edge = 16;  ///< edge of a cell in voxels

/// Returns stacks of cells at random places, each beginning at any multiple of 8. The shards do not exist.
SceneDescription random_stacks(std::mt19937_64& rng) {
  SceneDescription scene;
  scene.voxel_size_m = 1;
  for (std::int64_t y = -4; y < 4; ++y)
    for (std::int64_t x = -4; x < 4; ++x)
      for (std::int64_t z = -64 + 8 * std::int64_t(rng() % 4); z < 48;
           z += tier_cell_edge + (rng() % 3 == 0 ? tier_cell_edge : 0)) {
        SceneCell cell;
        cell.name = "c_" + std::to_string(scene.cells.size());
        cell.file = "shards/" + cell.name + ".h5";
        cell.lattice_min = {x * tier_cell_edge, y * tier_cell_edge, z};
        cell.cell_voxels = std::uint32_t(tier_cell_edge);
        cell.lods = 2;
        cell.voxels = {9, 3};
        cell.content_hash = {{rng(), rng()}, {rng(), rng()}};
        scene.cells.push_back(std::move(cell));
      }
  std::sort(scene.cells.begin(), scene.cells.end(), is_before);
  return scene;
}

/// Returns the overview levels for one root above all of these cells.
OverviewLevels one_root() {
  OverviewLevel level;
  level.first_lod = 2;
  level.lods = 4;
  level.bits = 8;
  level.origin = {-128, -128, -128};
  return {{level}, 0};
}

struct Asked {
  explicit Asked(const std::shared_ptr<const PagedScene>& scene)
      : map(*scene, one_root()), pager(pages_from_files(scene), {1, UINT64_MAX}) {}

  /// Reads missing pages and calls question() again until no page is missing.
  template <class Question>
  auto answer(const Question& question) {
    for (;;) {
      MissingPages missing_pages;
      missing_pages.own = own;
      auto found = question(missing_pages);
      damaged = missing_pages.damaged;
      if (missing_pages.missing.empty()) return found;
      pager.request(missing_pages.missing);
      pager.wait();
      pager.begin_pass();
    }
  }

  ShardMap map;
  Pager pager;
  VoxelBox own{{-1000, -1000, -1000}, {1000, 1000, 1000}};
  bool damaged = false;
};

VoxelBox random_box(std::mt19937_64& rng) {
  VoxelBox box;
  for (int a = 0; a < 3; ++a) {
    box.min[a] = std::int64_t(rng() % 180) - 90;
    box.max[a] = box.min[a] + 1 + std::int64_t(rng() % 40);
  }
  return box;
}

TEST(ShardMap, FindsTheCellsOfAnyPlaceThroughPagesOfPages) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  write_scene(folder / "scene.xml", random_stacks(rng), {4, 2, 8});
  const auto scene = std::make_shared<const PagedScene>(folder / "scene.xml");
  ASSERT_FALSE(scene->root().pages.empty());
  ASSERT_NE(scene->root().pages[0].groups, 0u);
  const std::vector<SceneCell> cells = scene->cells();
  Asked asked(scene);
  for (int round = 0; round < 300; ++round) {
    const VoxelBox box = random_box(rng);
    std::set<std::uint32_t> expected;
    std::optional<std::uint32_t> holds;
    for (std::uint32_t i = 0; i < cells.size(); ++i) {
      const Box3i64 window = window_of(cells[i]);
      const Box3i64 asked_for{box.min, box.max};
      if (!intersection(window, asked_for).is_empty()) expected.insert(i);
      if (window.contains(asked_for.min)) holds = i;
    }
    std::set<std::uint32_t> found;
    asked.answer([&](MissingPages& missing_pages) {
      return asked.map.any(1, 0, box, asked.pager, missing_pages, [&](const ShardExtent& shard) {
        found.insert(shard.number);
        return false;
      });
    });
    EXPECT_EQ(found, expected);
    VoxelBox empty;
    const auto shard = asked.answer(
        [&](MissingPages& missing_pages) { return asked.map.find(0, 0, box.min, asked.pager, missing_pages, empty); });
    ASSERT_EQ(shard.has_value(), holds.has_value());
    if (shard) {
      EXPECT_EQ(shard->number, *holds);
      continue;
    }
    for (int a = 0; a < 3; ++a) EXPECT_TRUE(empty.min[a] <= box.min[a] && box.min[a] < empty.max[a]);
    for (const SceneCell& cell : cells) {
      const Box3i64 window = window_of(cell);
      const VoxelBox other{window.min, window.end};
      EXPECT_FALSE(overlap(empty, other)) << cell.name << " overlaps the box that is reported as empty";
    }
  }
}

// Regression of 2026-11-27: a ray down through an empty part of a column took a step for each voxel.
TEST(ShardMap, SpansTheEmptyPartOfAColumn) {
  std::mt19937_64 rng(1);
  SceneDescription scene = random_stacks(rng);
  std::erase_if(scene.cells, [](const SceneCell& cell) { return cell.lattice_min[2] >= -32; });
  const TempFolder folder;
  write_scene(folder / "scene.xml", scene);
  Asked asked(std::make_shared<const PagedScene>(folder / "scene.xml"));
  for (const SceneCell& cell : scene.cells) {
    const Vec3i64 above{cell.lattice_min[0], cell.lattice_min[1], 60};
    VoxelBox empty;
    const auto shard = asked.answer(
        [&](MissingPages& missing_pages) { return asked.map.find(0, 0, above, asked.pager, missing_pages, empty); });
    EXPECT_FALSE(shard.has_value());
    EXPECT_EQ(empty.min[2], above[2] & -tier_cell_edge) << "the box is as high as a cell where there is none";
  }
}

TEST(ShardMap, SaysWhereAPageOfTheSceneCannotBeRead) {
  std::mt19937_64 rng(3);
  const TempFolder folder;
  write_scene(folder / "scene.xml", random_stacks(rng), {4, 2, 8});
  const auto scene = std::make_shared<const PagedScene>(folder / "scene.xml");
  const PageReference lost = scene->leaves().at(5);
  std::filesystem::remove(folder / lost.file);
  Asked asked(scene);
  VoxelBox empty;
  const Vec3i64& inside = lost.totals.window.min;
  const auto shard = asked.answer(
      [&](MissingPages& missing_pages) { return asked.map.find(0, 0, inside, asked.pager, missing_pages, empty); });
  EXPECT_FALSE(shard.has_value());
  EXPECT_TRUE(asked.damaged) << "the requested part is damaged";
  asked.own = {{-2000, 0, 0}, {-1999, 1, 1}};
  asked.answer(
      [&](MissingPages& missing_pages) { return asked.map.find(0, 0, inside, asked.pager, missing_pages, empty); });
  EXPECT_FALSE(asked.damaged) << "only another part is damaged";
  ASSERT_EQ(asked.pager.problems().size(), 1u);
  EXPECT_NE(asked.pager.problems()[0].find(lost.file), std::string::npos);
}

/// Returns a scene of two overview levels: cells of 16, overviews of 128, and a root at a multiple of half its edge.
SceneDescription two_tiers() {
  SceneDescription scene;
  scene.parameters = to_json(BakeParameters{.voxel_size_m = 1});
  const auto add = [](std::vector<SceneCell>& to, const Vec3i64& min, std::uint32_t voxels, std::uint32_t first_lod,
                      std::uint32_t lods) {
    SceneCell shard;
    shard.lattice_min = min;
    shard.cell_voxels = voxels;
    shard.first_lod = first_lod;
    shard.lods = lods;
    to.push_back(shard);
  };
  for (const std::int64_t x : {-128, 0, 112}) add(scene.cells, {x, 0, 120}, 16, 0, 2);
  for (const std::int64_t x : {-128, 0})
    for (const std::int64_t z : {0, 128}) add(scene.overviews, {x, 0, z}, 128, 2, 3);
  add(scene.overviews, {-128, 0, 0}, 256, 5, 1);
  return scene;
}

std::optional<OverviewLevels> tiers_of(const SceneDescription& scene) {
  return overview_levels(PagedScene::of_cells("scene.xml", scene));
}

/// Returns two_tiers() with duplicated levels. Overviews duplicate a level of the cells. The root duplicates all four
/// levels of its children, one of which is a duplicate already.
SceneDescription two_levels_with_copies() {
  SceneDescription scene = two_tiers();
  for (SceneCell& overview : scene.overviews) {
    const std::uint32_t copied = overview.cell_voxels == 256 ? 4 : 1;
    overview.first_lod -= copied, overview.lods += copied, overview.copied_lods = copied;
  }
  return scene;
}

TEST(OverviewLevels, NameTheOverviewsOfALevelInOrderOfSize) {
  const auto levels = tiers_of(two_levels_with_copies());
  ASSERT_TRUE(levels.has_value());
  EXPECT_EQ(levels->holders(0), 0u);
  for (const int lod : {1, 2, 3, 4}) {
    ASSERT_EQ(levels->holders(lod), 2u) << lod;
    EXPECT_EQ(levels->provider(lod, 0).bits, 8) << lod;
    EXPECT_EQ(levels->provider(lod, 1).bits, 7) << lod;
  }
  ASSERT_EQ(levels->holders(5), 1u);
  SceneDescription scene = two_levels_with_copies();
  scene.overviews[1].copied_lods = 0;
  EXPECT_FALSE(tiers_of(scene).has_value()) << "an overview that copies something else than its neighbours";
}

TEST(ShardMap, RequestsTheShardsOfALevelInOrderOfSizeAndTheCellsLast) {
  const auto scene = std::make_shared<const PagedScene>(PagedScene::of_cells("scene.xml", two_levels_with_copies()));
  const ShardMap map(*scene, *overview_levels(*scene));
  const Pager pager([](const PageKey&) { return Page(); }, {1, UINT64_MAX});
  MissingPages missing_pages;
  VoxelBox empty;
  const Vec3i64 v{0, 0, 130};
  EXPECT_EQ(map.last_provider(0), 0);
  EXPECT_EQ(map.last_provider(1), 2);
  EXPECT_EQ(map.last_provider(4), 1);
  EXPECT_EQ(map.find(1, 0, v, pager, missing_pages, empty)->number, 7u)
      << "the root, behind three cells and four overviews";
  EXPECT_EQ(map.find(1, 1, v, pager, missing_pages, empty)->window.max[2], 256);
  EXPECT_FALSE(map.find(1, 2, v, pager, missing_pages, empty)->is_overview());
  EXPECT_FALSE(map.find(0, 0, v, pager, missing_pages, empty)->is_overview());
}

TEST(OverviewLevels, AreThereOnlyWhereAllOfASceneHangsFromOneRoot) {
  const SceneDescription good = two_tiers();
  const auto levels = tiers_of(good);
  ASSERT_TRUE(levels.has_value());
  EXPECT_EQ(levels->root, 4u);
  EXPECT_EQ(levels->provider(4, 0).edge(), 128);
  EXPECT_EQ(levels->provider(5, 0).bits, 8);
  EXPECT_EQ(levels->holders(1), 0u);
  EXPECT_EQ(levels->holders(4), 1u);
  // 2026-11-25: viewers opened every cell of a scene that was baked with `max_error`.
  SceneDescription lossy = good;
  lossy.parameters = to_json(BakeParameters{.voxel_size_m = 1, .max_error = 3});
  EXPECT_TRUE(tiers_of(lossy).has_value());
  const auto refused = [&](const char* what, const auto& change) {
    SceneDescription scene = good;
    change(scene);
    EXPECT_FALSE(tiers_of(scene).has_value()) << what;
  };
  refused("no overviews", [](SceneDescription& s) { s.overviews.clear(); });
  refused("no root", [](SceneDescription& s) { s.overviews.pop_back(); });
  refused("two roots", [](SceneDescription& s) { s.overviews.push_back(s.overviews.back()); });
  refused("a window twice", [](SceneDescription& s) { s.overviews[1].lattice_min = s.overviews[0].lattice_min; });
  refused("a window off its lattice", [](SceneDescription& s) { s.overviews[1].lattice_min[0] += 16; });
  refused("a root off its lattice", [](SceneDescription& s) { s.overviews[4].lattice_min[1] = 64; });
  refused("an overview outside of the root", [](SceneDescription& s) { s.overviews[0].lattice_min[1] = 256; });
  refused("levels that are missing", [](SceneDescription& s) { s.overviews[4].first_lod = 6; });
  refused("another number of levels", [](SceneDescription& s) { s.overviews[2].lods = 2; });
  refused("no power of two", [](SceneDescription& s) { s.overviews[4].cell_voxels = 255; });
  refused("far away", [](SceneDescription& s) {
    for (SceneCell& p : s.overviews) p.lattice_min[2] += std::int64_t(1) << 52;
  });
  refused("cells of several sizes", [](SceneDescription& s) { s.cells[0].cell_voxels = 32; });
  refused("a cell that reaches into a block without an overview", [](SceneDescription& s) {
    s.overviews.erase(s.overviews.begin() + 3);
    s.losses.push_back({"cell c", "was not baked"});
  });
}

}  // namespace
}  // namespace gigabake
