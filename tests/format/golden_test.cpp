#include <cstdlib>
#include <gtest/gtest.h>

#include "format/scene_xml.h"
#include "format/verify.h"
#include "made_shard.h"

namespace gigabake {
namespace {

/// The same scene in every version of the format, each as it was committed when that version was made; today's reader
/// reads all of them. GIGABAKE_WRITE_GOLDEN=1 writes today's anew.
std::filesystem::path golden(int version) {
  return std::filesystem::path(GIGABAKE_SOURCE_DIR) / "tests/format/golden" / ("version_" + std::to_string(version));
}
constexpr int newest = 2;

class Golden : public testing::TestWithParam<int> {};

TEST_P(Golden, SceneReadsAsOnTheDayItWasWritten) {
  const std::filesystem::path folder = golden(GetParam());
  if (GetParam() == newest && std::getenv("GIGABAKE_WRITE_GOLDEN") != nullptr)
    made::write_scene_of(folder / "scene.xml", {made::small_shard()});
  const SceneDescription scene = read_scene(folder / "scene.xml");
  ASSERT_EQ(scene.cells.size(), 1u);
  EXPECT_EQ(scene.voxel_size_m, 0.25);
  EXPECT_EQ(scene.lattice_origin_m, (std::array<double, 3>{100.5, -3, 0}));
  EXPECT_EQ(scene.origin, (Geodetic{34.4263, -119.8404, 2.5}));
  EXPECT_EQ(scene.cells[0].voxels, (std::vector<std::uint64_t>{515, 2}));
  EXPECT_EQ(scene.cells[0].fingerprint.hex(), "00000000000000020000000000000001");
  EXPECT_EQ(made::difference(read_shard(folder / scene.cells[0].file), made::small_shard()), "");
  EXPECT_EQ(verify_scene(folder / "scene.xml", 1).faults, std::vector<std::string>());
}

INSTANTIATE_TEST_SUITE_P(Versions, Golden, testing::Range(1, newest + 1));

TEST(GoldenToday, WriterStoresWhatTheNewestVersionStores) {
  const made::TempFolder folder;
  const SceneDescription today = made::write_scene_of(folder / "scene.xml", {made::small_shard()});
  const SceneDescription then = read_scene(golden(newest) / "scene.xml");
  EXPECT_EQ(made::difference(read_shard(folder / today.cells[0].file), read_shard(golden(newest) / then.cells[0].file)),
            "");
  EXPECT_EQ(today.cells[0].content_hash, then.cells[0].content_hash);
}

}  // namespace
}  // namespace gigabake
