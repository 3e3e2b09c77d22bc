#include <cstdlib>
#include <gtest/gtest.h>

#include "format/scene_xml.h"
#include "format/verify.h"
#include "made_shard.h"

namespace gigabake {
namespace {

/// A scene of format version 1, as it was committed when that format was made. Formats that follow get a folder of
/// their own, and every reader reads all of them. GIGABAKE_WRITE_GOLDEN=1 writes today's anew.
const std::filesystem::path golden = std::filesystem::path(GIGABAKE_SOURCE_DIR) / "tests/format/golden/version_1";

TEST(Golden, SceneOfVersion1ReadsAsOnTheDayItWasWritten) {
  if (std::getenv("GIGABAKE_WRITE_GOLDEN") != nullptr)
    made::write_scene_of(golden / "scene.xml", {made::small_shard()});
  const SceneDescription scene = read_scene(golden / "scene.xml");
  ASSERT_EQ(scene.cells.size(), 1u);
  EXPECT_EQ(scene.voxel_size_m, 0.25);
  EXPECT_EQ(scene.lattice_origin_m, (std::array<double, 3>{100.5, -3, 0}));
  EXPECT_EQ(scene.origin, (Geodetic{34.4263, -119.8404, 2.5}));
  EXPECT_EQ(scene.cells[0].voxels, (std::vector<std::uint64_t>{515, 2}));
  EXPECT_EQ(scene.cells[0].fingerprint.hex(), "00000000000000020000000000000001");
  EXPECT_EQ(made::difference(read_shard(golden / scene.cells[0].file), made::small_shard()), "");
  EXPECT_EQ(verify_scene(golden / "scene.xml", 1).faults, std::vector<std::string>());
}

TEST(Golden, TodaysWriterStoresWhatVersion1Stores) {
  const made::TempFolder folder;
  const SceneDescription today = made::write_scene_of(folder / "scene.xml", {made::small_shard()});
  const SceneDescription then = read_scene(golden / "scene.xml");
  EXPECT_EQ(made::difference(read_shard(folder / today.cells[0].file), read_shard(golden / then.cells[0].file)), "");
  EXPECT_EQ(today.cells[0].content_hash, then.cells[0].content_hash);
}

}  // namespace
}  // namespace gigabake
