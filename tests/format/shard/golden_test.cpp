#include <cstdlib>
#include <gtest/gtest.h>

#include "format/scene/check/verify.h"
#include "format/scene/xml/scene_reading.h"
#include "made_shard.h"

namespace gigabake {
namespace {

/// A version of the file format. The repository has the same scene in each version, as committed when the version was
/// introduced. The current reader reads all of them. GIGABAKE_WRITE_GOLDEN=1 writes the current version again.
struct Version {
  std::string folder;  ///< named after the version of the shards, and of scene.xml if it has one
  bool has_totals;
  bool has_planes = false, has_above = false, has_overview = false, has_finest_planes = false, has_classes = false;

  Shard shard() const {
    Shard shard = has_planes ? made::small_shard_with_planes(has_finest_planes ? 6 : 5) : made::small_shard();
    if (has_above) shard.above = made::small_above();
    return has_classes ? made::with_classes(std::move(shard)) : shard;
  }
  std::vector<Shard> shards() const {
    if (!has_overview) return {shard()};
    return {shard(), overview()};
  }
  Shard overview() const { return has_classes ? made::with_classes(made::small_overview()) : made::small_overview(); }
};
/// The versions of scenes without classes and with classes, first without the table of chunks.
const Version version_7{"version_7_scene_5", true, true, true, true, true},
    version_9{"version_9_scene_7", true, true, true, true, true, true},
    newest{"version_7_scene_5_chunks", true, true, true, true, true},
    newest_with_classes{"version_9_scene_7_chunks", true, true, true, true, true, true};

std::filesystem::path golden(const Version& version) {
  return std::filesystem::path(GIGABAKE_SOURCE_DIR) / "tests/format/golden" / version.folder;
}

class Golden : public testing::TestWithParam<Version> {};

TEST_P(Golden, SceneReadsAsOnTheDayItWasWritten) {
  const std::filesystem::path folder = golden(GetParam());
  const bool is_newest = GetParam().folder == newest.folder || GetParam().folder == newest_with_classes.folder;
  if (is_newest && std::getenv("GIGABAKE_WRITE_GOLDEN") != nullptr)
    made::write_scene_of(folder / "scene.xml", GetParam().shards());
  const SceneDescription scene = read_scene(folder / "scene.xml");
  ASSERT_EQ(scene.cells.size(), 1u);
  EXPECT_EQ(scene.voxel_size_m, 0.25);
  EXPECT_EQ(scene.lattice_origin_m, (Vec3d{100.5, -3, 0}));
  EXPECT_EQ(scene.origin, (Geodetic{34.4263, -119.8404, 2.5}));
  EXPECT_EQ(scene.cells[0].voxels, (std::vector<std::uint64_t>{515, 2}));
  EXPECT_EQ(scene.cells[0].fingerprint.hex(), "00000000000000020000000000000001");
  EXPECT_EQ(made::difference(read_shard(folder / scene.cells[0].file), GetParam().shard()), "");
  EXPECT_EQ(read_shard(folder / scene.cells[0].file).above, GetParam().shard().above);
  ASSERT_EQ(scene.overviews.size(), GetParam().shards().size() - 1);
  for (const SceneCell& overview : scene.overviews) {
    EXPECT_EQ(made::difference(read_shard(folder / overview.file), GetParam().overview()), "");
    EXPECT_EQ(overview.copied_lods, 1u);
  }
  const VerifyResult verified = verify_scene(folder / "scene.xml", 1);
  EXPECT_EQ(verified.faults, std::vector<std::string>());
  EXPECT_EQ(verified.has_totals, GetParam().has_totals);
}

INSTANTIATE_TEST_SUITE_P(Versions, Golden,
                         testing::Values(Version{"version_1", false}, Version{"version_2", false},
                                         Version{"version_2_scene_2", true}, Version{"version_3_scene_2", true, true},
                                         Version{"version_4_scene_3", true, true, true},
                                         Version{"version_5_scene_4", true, true, true, true},
                                         Version{"version_5_scene_5", true, true, true, true},
                                         Version{"version_6_scene_5", true, true, true, true, true}, version_7,
                                         version_9, newest, newest_with_classes),
                         [](const auto& version) { return version.param.folder; });

TEST(GoldenToday, WriterStoresWhatTheNewestVersionStores) {
  for (const Version& version : {newest, newest_with_classes}) {
    const made::TempFolder folder;
    const SceneDescription today = made::write_scene_of(folder / "scene.xml", version.shards());
    const SceneDescription then = read_scene(golden(version) / "scene.xml");
    EXPECT_EQ(
        made::difference(read_shard(folder / today.cells[0].file), read_shard(golden(version) / then.cells[0].file)),
        "");
    EXPECT_EQ(today.cells[0].content_hash, then.cells[0].content_hash);
    const StoredTotals said = read_scene_text(folder / "scene.xml").said.value();
    const StoredTotals said_then = read_scene_text(golden(version) / "scene.xml").said.value();
    EXPECT_EQ(said.voxels, said_then.voxels);
    EXPECT_EQ(said.content_hash, said_then.content_hash);
  }
}

}  // namespace
}  // namespace gigabake
