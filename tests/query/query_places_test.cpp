// Lookup of shards: only the pages of the scene that a lookup needs are read.
#include "query/query_places.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/octree/parameters.h"
#include "query/query_device.h"
#include "tests/format/shard/made_shard.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using Corner = Vec3i64;

constexpr std::uint32_t cell_edge = 16, levels = 2, root_edge = 1024;
constexpr PageRule small_pages{4, 2, 8};

SceneCell listed(const std::string& name, const Corner& min, std::uint32_t first_lod, std::uint32_t edge) {
  SceneCell shard;
  shard.name = name;
  shard.file = "shards/" + name + ".h5";
  shard.lattice_min = min;
  shard.cell_voxels = edge;
  shard.first_lod = first_lod;
  shard.lods = levels;
  shard.voxels = {9, 3};
  shard.content_hash = {{1, 2}, {3, 4}};
  return shard;
}

std::string name_of(const std::string& prefix, const Corner& min) {
  std::string name = prefix;
  for (const std::int64_t c : min) name += "_" + std::to_string(c);
  return name;
}

/// Returns cells at random heights, and all overviews above them up to one root.
SceneDescription scene_below_one_root(std::mt19937_64& rng) {
  SceneDescription scene;
  scene.generator = "gigabake test";
  scene.voxel_size_m = 1;
  scene.parameters = to_json(BakeParameters{.voxel_size_m = 1});
  std::set<Corner> below;
  for (std::int64_t y = -16; y < 16; ++y)
    for (std::int64_t x = -16; x < 16; ++x) {
      const Corner min{cell_edge * x, cell_edge * y, 8 * std::int64_t(rng() % 12) - 40};
      scene.cells.push_back(listed(name_of("c", min), min, 0, cell_edge));
      below.insert(min);
      below.insert({min[0], min[1], min[2] + cell_edge - 1});
    }
  std::sort(scene.cells.begin(), scene.cells.end(), is_before);
  std::uint32_t edge = cell_edge;
  for (std::uint32_t lod = levels; edge < root_edge; lod += levels) {
    edge <<= levels;
    std::set<Corner> tier;
    for (const Corner& v : below) tier.insert(edge == root_edge ? Corner{-512, -512, -512} : block_around(v, edge).min);
    for (const Corner& min : tier)
      scene.overviews.push_back(listed(name_of("p" + std::to_string(lod), min), min, lod, edge));
    below = tier;
  }
  return scene;
}

/// Reads missing pages until the place is known.
QueryPlace place_of(QueryPlaces& places, int lod, const Corner& v) {
  for (;;) {
    const QueryPlace place = places.find(lod, v.v);
    if (place.kind != QueryPlace::Kind::unknown) {
      places.read({});
      return place;
    }
    places.read({place.page});
  }
}

/// Returns the shard that has level `lod` and contains v, by a linear search.
std::string provider_of(const SceneDescription& scene, int lod, const Corner& v) {
  for (const SceneCell& shard : lod < int(levels) ? scene.cells : scene.overviews)
    if (int(shard.own_lod()) <= lod && lod < int(shard.own_lod() + shard.lods) && window_of(shard).contains(v))
      return shard.name;
  return "";
}

// 2026-11-25: all pages of a scene were read before the first answer.
TEST(QueryPlaces, ReadThePagesOnTheWayToAPlaceAlone) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const made::TempFolder folder;
  const SceneDescription made = scene_below_one_root(rng);
  write_scene(folder / "scene.xml", made, small_pages);
  const auto scene = std::make_shared<const PagedScene>(folder / "scene.xml");
  std::uint64_t pages = 0;
  scene->for_each_reference([&](const PageReference&) { ++pages; });
  ASSERT_GT(pages, 200u);
  NumberedShards numbers(scene, {});
  const ThreadPool pool(2);
  QueryPlaces places(numbers, 1 << 16, pool);
  EXPECT_EQ(places.pages_read(), 0u);
  EXPECT_EQ(places.lods(), 8);
  EXPECT_EQ(place_of(places, 7, {0, 0, 0}).kind, QueryPlace::Kind::shard);
  EXPECT_EQ(places.pages_read(), 0u) << "the root is in scene.xml";
  place_of(places, 0, {100, 100, 0});
  EXPECT_LE(places.pages_read(), 16u);
  for (int round = 0; round < 2000; ++round) {
    const int lod = int(rng() % 8);
    Corner v;
    for (std::size_t a = 0; a < 3; ++a) v[a] = std::int64_t(rng() % (a == 2 ? 160 : 540)) - (a == 2 ? 60 : 270);
    const QueryPlace place = place_of(places, lod, v);
    const std::string expected = provider_of(made, lod, v);
    ASSERT_EQ(place.kind == QueryPlace::Kind::shard, !expected.empty()) << seed << " level " << lod;
    if (!expected.empty()) {
      ASSERT_EQ(numbers.shard(place.shard).name, expected) << seed;
    }
    for (std::size_t a = 0; a < 3; ++a) {
      ASSERT_LE(place.box.min[a], v[a]) << seed;
      ASSERT_GT(place.box.max[a], v[a]) << seed;
    }
  }
}

// A ray of a device pauses in a region of QueryCells and is resumed in the place that QueryPlaces finds. Regions and
// places must be equal.
TEST(QueryCells, FindTheRegionsThatPagesDescribe) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const made::TempFolder folder;
  write_scene(folder / "scene.xml", scene_below_one_root(rng), small_pages);
  NumberedShards numbers(std::make_shared<const PagedScene>(folder / "scene.xml"), {});
  const ThreadPool pool(2);
  QueryPlaces places(numbers, 1 << 20, pool);
  places.lay_out_all(pool);
  EXPECT_TRUE(places.has_pages());
  std::vector<kernels::QueryCells::Entry> entries;
  const kernels::QueryCells cells = query_cells(places, entries);
  for (int round = 0; round < 20000; ++round) {
    Corner v;
    for (std::size_t a = 0; a < 3; ++a) v[a] = std::int64_t(rng() % (a == 2 ? 160 : 600)) - (a == 2 ? 60 : 300);
    const QueryPlace expected = place_of(places, 0, v);
    const QueryRegion region = cells.find(0, v.v);
    ASSERT_EQ(region.kind == QueryRegion::Kind::paused, expected.kind == QueryPlace::Kind::shard) << seed;
    ASSERT_EQ(region.shard, expected.shard) << seed;
    for (int a = 0; a < 3; ++a) {
      ASSERT_EQ(region.box.min[a], expected.box.min[a]) << seed;
      ASSERT_EQ(region.box.max[a], expected.box.max[a]) << seed;
    }
  }
}

TEST(QueryPlaces, NameAPageThatCannotBeRead) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const made::TempFolder folder;
  write_scene(folder / "scene.xml", scene_below_one_root(rng), small_pages);
  const auto scene = std::make_shared<const PagedScene>(folder / "scene.xml");
  std::filesystem::remove_all(folder / "pages");
  NumberedShards numbers(scene, {});
  const ThreadPool pool(1);
  QueryPlaces places(numbers, 1 << 20, pool);
  EXPECT_THROW(place_of(places, 0, {100, 100, 0}), InputError);
}

}  // namespace
}  // namespace gigabake
