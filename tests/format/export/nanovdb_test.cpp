// Exports are read back with the NanoVDB library if its headers are installed.
#include "format/export/nanovdb/nanovdb.h"

#include <fstream>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/math/octahedral.h"
#include "tests/format/scene/scene_voxels.h"
#include "tests/format/shard/made_shard.h"
#include "tests/format/system/small_disk.h"

#if __has_include(<nanovdb/NanoVDB.h>)
#define GIGABAKE_TEST_NANOVDB
#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/GridValidator.h>
#include <nanovdb/util/IO.h>
#endif

namespace gigabake {
namespace {

using made::TempFolder;

TEST(Nanovdb, IsNotWrittenWhereTheSceneHasNoSuchLevelOrAShardIsDamaged) {
  const TempFolder folder;
  made::write_scene_of(folder / "scene.xml", {made::small_shard()});
  EXPECT_THROW(export_nanovdb(folder / "scene.xml", 2, folder / "v.nvdb"), InputError);
  std::filesystem::resize_file(folder / "shards/c_0_0_0.h5", 100);
  EXPECT_THROW(export_nanovdb(folder / "scene.xml", 0, folder / "v.nvdb"), InputError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
}

TEST(Nanovdb, RefusesIndicesBeyond32Bits) {
  const TempFolder folder;
  const std::int64_t far = std::int64_t(1) << 33;
  made::write_scene_of(folder / "scene.xml", {made::shard_of({{{far, 0, 0}, {1, 1, 1, 1}, {}}}, {far, 0, 0}, 8)});
  EXPECT_THROW(export_nanovdb(folder / "scene.xml", 0, folder / "v.nvdb"), InputError);
}

TEST(Nanovdb, LeavesNothingBehindOnAFullDisk) {
  const TempFolder folder;
  made::write_scene_of(folder / "scene.xml", {made::small_shard()});
  {
    const SmallDisk disk(10000);
    EXPECT_THROW(export_nanovdb(folder / "scene.xml", 0, folder / "v.nvdb"), InputError);
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
}

TEST(Nanovdb, IsTheSameFileEachTime) {
  const TempFolder folder;
  std::mt19937_64 rng(5);
  made::write_random_scene(folder / "scene.xml", rng, true);
  const auto bytes = [&] {
    export_nanovdb(folder / "scene.xml", 0, folder / "v.nvdb");
    std::ifstream file(folder / "v.nvdb", std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  EXPECT_EQ(bytes(), bytes());
}

#ifdef GIGABAKE_TEST_NANOVDB
template <class Value, class Visit>
void for_each_active(const nanovdb::NanoGrid<Value>& grid, const Visit& visit) {
  for (auto upper = grid.tree().root().beginChild(); upper; ++upper)
    for (auto lower = upper->beginChild(); lower; ++lower)
      for (auto leaf = lower->beginChild(); leaf; ++leaf) {
        for (auto voxel = leaf->beginValueOn(); voxel; ++voxel) {
          const nanovdb::Coord at = voxel.getCoord();
          ASSERT_TRUE(leaf->bbox().isInside(at) && lower->bbox().isInside(at) && upper->bbox().isInside(at));
          visit(Vec3i64::from(at), *voxel);
        }
      }
}

template <class Value>
void expect_sound(const nanovdb::NanoGrid<Value>& grid, const made::SceneVoxels& voxels) {
  std::string error = nanovdb::GridValidator<Value>::check(grid, true);
  EXPECT_EQ(error, "");
  EXPECT_EQ(grid.activeVoxelCount(), voxels.size());
  EXPECT_EQ(grid.gridClass(), nanovdb::GridClass::VoxelVolume);
  EXPECT_TRUE(grid.hasBBox() && grid.isBreadthFirst());
  Vec3i64 low = voxels.begin()->first, high = low;
  for (const auto& [at, voxel] : voxels) {
    low = min_by_axis(low, at);
    high = max_by_axis(high, at);
  }
  const nanovdb::CoordBBox box = grid.indexBBox();
  EXPECT_EQ(Vec3i64::from(box.min()), low);
  EXPECT_EQ(Vec3i64::from(box.max()), high);
}

void expect_same_classes(const nanovdb::NanoGrid<std::uint32_t>* classes, const made::SceneVoxels& voxels) {
  ASSERT_NE(classes, nullptr);
  EXPECT_STREQ(classes->gridName(), "class");
  expect_sound(*classes, voxels);
  for_each_active(*classes,
                  [&](const Vec3i64& at, std::uint32_t value) { EXPECT_EQ(value, voxels.at(at).voxel_class); });
}

void expect_same_voxels(const std::filesystem::path& nvdb, const made::SceneVoxels& voxels,
                        const SceneDescription& scene) {
  const auto grids = nanovdb::io::readGrids(nvdb.string());
  const bool normals = scene.has_normals;
  ASSERT_EQ(grids.size(), 1u + (normals ? 1 : 0) + (scene.has_classes ? 1 : 0));
  if (scene.has_classes) expect_same_classes(grids.back().grid<std::uint32_t>(), voxels);
  const auto* rgba = grids[0].grid<nanovdb::Rgba8>();
  ASSERT_NE(rgba, nullptr);
  EXPECT_STREQ(rgba->gridName(), "rgba");
  expect_sound(*rgba, voxels);
  std::size_t seen = 0;
  for_each_active(*rgba, [&](const Vec3i64& at, const nanovdb::Rgba8& value) {
    const std::array<std::uint8_t, 4> bytes{value.r(), value.g(), value.b(), value.a()};
    ASSERT_TRUE(voxels.contains(at));
    EXPECT_EQ(voxels.at(at).rgba, bytes);
    ++seen;
  });
  EXPECT_EQ(seen, voxels.size());
  if (!normals) return;
  const auto* normal = grids[1].grid<nanovdb::Vec3f>();
  ASSERT_NE(normal, nullptr);
  EXPECT_STREQ(normal->gridName(), "normal");
  expect_sound(*normal, voxels);
  for_each_active(*normal, [&](const Vec3i64& at, const nanovdb::Vec3f& value) {
    EXPECT_EQ(Vec3<float>::from(value), unit_normal(voxels.at(at).normal.data()));
  });
  const auto access = rgba->getAccessor();
  for (const auto& [at, voxel] : voxels)
    EXPECT_EQ(access.getValue({int(at[0]), int(at[1]), int(at[2])}).a(), voxel.rgba[3]);
}

TEST(Nanovdb, TheLibraryReadsTheVoxelsOfEveryLevelOfARandomScene) {
  for (int round = 0; round < 6; ++round) {
    const made::RandomScene scene(round, true);
    for (int lod = 0; lod < 4; ++lod) {
      const made::SceneVoxels voxels = scene.voxels(lod);
      EXPECT_EQ(export_nanovdb(scene.xml(), lod, scene / "v.nvdb"), voxels.size());
      expect_same_voxels(scene / "v.nvdb", voxels, scene.description());
    }
  }
}

TEST(Nanovdb, AnIndexMapsToTheLowestCornerOfItsVoxel) {
  const TempFolder folder;
  made::write_scene_of(folder / "scene.xml", {made::small_shard()});
  export_nanovdb(folder / "scene.xml", 1, folder / "v.nvdb");
  const auto grids = nanovdb::io::readGrids((folder / "v.nvdb").string());
  const auto& grid = *grids.at(0).grid<nanovdb::Rgba8>();
  EXPECT_EQ(grid.voxelSize(), nanovdb::Vec3d(0.5));
  EXPECT_EQ(grid.indexToWorld(nanovdb::Vec3d(-8, 16, 4)), nanovdb::Vec3d(100.5 - 4, -3 + 8, 2));
  EXPECT_EQ(grid.worldToIndex(nanovdb::Vec3d(100.5 - 4, -3 + 8, 2)), nanovdb::Vec3d(-8, 16, 4));
  EXPECT_EQ(grid.worldBBox().min(), nanovdb::Vec3d(100.5 - 4, -3 + 8, 2));
  EXPECT_EQ(grid.worldBBox().max(), nanovdb::Vec3d(100.5 - 3, -3 + 8.5, 2.5));
}

TEST(Nanovdb, AnyGridCanBeReadByItsName) {
  const TempFolder folder;
  made::write_scene_of(folder / "scene.xml", {made::small_shard()});
  export_nanovdb(folder / "scene.xml", 0, folder / "v.nvdb");
  EXPECT_TRUE(nanovdb::io::readGrid((folder / "v.nvdb").string(), "rgba").grid<nanovdb::Rgba8>() != nullptr);
  EXPECT_TRUE(nanovdb::io::readGrid((folder / "v.nvdb").string(), "normal").grid<nanovdb::Vec3f>() != nullptr);
  EXPECT_EQ(nanovdb::io::readGridMetaData((folder / "v.nvdb").string()).at(1).voxelCount, 515u);
}
#else
TEST(Nanovdb, TheLibraryReadsTheVoxelsOfEveryLevelOfARandomScene) {
  GTEST_SKIP() << "NanoVDB's headers are not installed (libnanovdb-dev)";
}
#endif

}  // namespace
}  // namespace gigabake
