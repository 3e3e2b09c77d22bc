// Exports are read back with the OpenVDB library. The tests are skipped in builds without OpenVDB.
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/math/octahedral.h"
#include "core/math/srgb.h"
#include "format/export/openvdb/openvdb_export.h"
#include "tests/format/scene/scene_voxels.h"
#include "tests/format/shard/made_shard.h"
#include "tests/format/system/small_disk.h"

#ifdef GIGABAKE_HAS_OPENVDB
#include <openvdb/openvdb.h>
#endif

namespace gigabake {
namespace {

using made::TempFolder;

TEST(Srgb, EveryByteComesBackFromLinearLightAlsoThroughAFloat) {
  for (int byte = 0; byte < 256; ++byte) EXPECT_EQ(srgb_byte(double(float(linear_of_srgb()[std::size_t(byte)]))), byte);
}

#ifdef GIGABAKE_HAS_OPENVDB
constexpr std::uint64_t enough = std::uint64_t(1) << 32;

std::uint8_t rounded(float share) { return std::uint8_t(std::lround(share * 255)); }

void expect_same_grid(const std::filesystem::path& vdb, const made::SceneVoxels& voxels,
                      const SceneDescription& scene) {
  openvdb::initialize();
  openvdb::io::File file(vdb.string());
  file.open();
  EXPECT_EQ(file.getGrids()->size(), 2u + (scene.has_normals ? 1 : 0) + (scene.has_classes ? 1 : 0));
  const auto density = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("density"));
  const auto colour = openvdb::gridPtrCast<openvdb::Vec3SGrid>(file.readGrid("Cd"));
  ASSERT_EQ(density->activeVoxelCount(), voxels.size());
  ASSERT_EQ(colour->activeVoxelCount(), voxels.size());
  EXPECT_EQ(density->getGridClass(), openvdb::GRID_FOG_VOLUME);
  for (auto v = density->cbeginValueOn(); v; ++v) {
    const openvdb::Coord at = v.getCoord();
    const made::VoxelBytes& voxel = voxels.at({at[0], at[1], at[2]});
    const openvdb::Vec3f light = colour->tree().getValue(at);
    const std::array<std::uint8_t, 4> rgba{srgb_byte(light[0]), srgb_byte(light[1]), srgb_byte(light[2]), rounded(*v)};
    EXPECT_EQ(rgba, voxel.rgba);
  }
  if (scene.has_classes) {
    const auto classes = openvdb::gridPtrCast<openvdb::Int32Grid>(file.readGrid("class"));
    ASSERT_EQ(classes->activeVoxelCount(), voxels.size());
    for (auto v = classes->cbeginValueOn(); v; ++v)
      EXPECT_EQ(*v, voxels.at({v.getCoord()[0], v.getCoord()[1], v.getCoord()[2]}).voxel_class);
  }
  if (!scene.has_normals) return;
  const auto normal = openvdb::gridPtrCast<openvdb::Vec3SGrid>(file.readGrid("N"));
  ASSERT_EQ(normal->activeVoxelCount(), voxels.size());
  for (auto v = normal->cbeginValueOn(); v; ++v) {
    const openvdb::Coord at = v.getCoord();
    EXPECT_EQ(Vec3<float>::from(*v), unit_normal(voxels.at({at[0], at[1], at[2]}).normal.data()));
  }
}

TEST(Openvdb, TheLibraryReadsTheVoxelsOfEveryLevelOfARandomScene) {
  for (int round = 0; round < 3; ++round) {
    const made::RandomScene scene(round, true);
    for (int lod = 0; lod < 4; ++lod) {
      const made::SceneVoxels voxels = scene.voxels(lod);
      EXPECT_EQ(export_openvdb(scene.xml(), lod, scene / "v.vdb", enough), voxels.size());
      expect_same_grid(scene / "v.vdb", voxels, scene.description());
    }
  }
}

TEST(Openvdb, AnIndexIsAtItsVoxelsCentreAndTheGridSaysWhereOnTheEarth) {
  const TempFolder folder;
  made::write_scene_of(folder / "scene.xml", {made::small_shard()});
  export_openvdb(folder / "scene.xml", 1, folder / "v.vdb", enough);
  openvdb::io::File file((folder / "v.vdb").string());
  file.open();
  const auto grid = file.readGrid("density");
  EXPECT_EQ(grid->transform().indexToWorld(openvdb::Coord(-8, 16, 4)), openvdb::Vec3d(100.5 - 3.75, -3 + 8.25, 2.25));
  EXPECT_EQ(grid->metaValue<double>("latitude_deg"), 34.4263);
  EXPECT_EQ(grid->metaValue<double>("height_m"), 2.5);
}

TEST(Openvdb, IsNotWrittenWhereItDoesNotFitTheMemoryOrTheDiskOrAShardIsDamaged) {
  const TempFolder folder;
  std::vector<made::Voxel> voxels;
  for (std::int64_t i = 0; i < 16 * 16; ++i) voxels.push_back({{8 * (i % 16), 8 * (i / 16), 0}, {1, 1, 1, 1}, {}});
  made::write_scene_of(folder / "scene.xml", {made::shard_of(voxels, {0, 0, 0}, 128)});
  EXPECT_THROW(export_openvdb(folder / "scene.xml", 0, folder / "v.vdb", 1 << 20), InputError);
  {
    const SmallDisk disk(20000);
    EXPECT_THROW(export_openvdb(folder / "scene.xml", 0, folder / "v.vdb", enough), InputError);
  }
  std::filesystem::resize_file(folder / "shards/c_0_0_0.h5", 100);
  EXPECT_THROW(export_openvdb(folder / "scene.xml", 0, folder / "v.vdb", enough), InputError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
}
#else
TEST(Openvdb, ABuildWithoutTheLibrarySaysSo) {
  EXPECT_THROW(export_openvdb("scene.xml", 0, "v.vdb", 0), UsageError);
  GTEST_SKIP() << "this build has no OpenVDB (libopenvdb-dev)";
}
#endif

}  // namespace
}  // namespace gigabake
