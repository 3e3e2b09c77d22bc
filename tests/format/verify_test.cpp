#include "format/verify.h"

#include <fstream>
#include <gtest/gtest.h>
#include <random>

#include "format/error.h"
#include "made_shard.h"

namespace gigabake {
namespace {

using made::TempFolder;

/// Two whole cells side by side.
std::vector<Shard> two_cells() {
  std::mt19937_64 rng(5);
  std::vector<Shard> shards{made::random_shard(rng, {3, true, 5}), made::random_shard(rng, {3, true, 5})};
  for (std::size_t i = 0; i < 2; ++i) {
    shards[i].header.lattice_min = {32 * std::int64_t(i), 0, 8};
    shards[i].header.origin.reset();
    shards[i].header.cell = i == 0 ? "left" : "right";
    shards[i] = made::with_content_hash(std::move(shards[i]));
  }
  return shards;
}

std::string all_faults(const std::filesystem::path& scene_xml) {
  std::string text;
  for (const std::string& fault : verify_scene(scene_xml, 2).faults) text += fault + "\n";
  return text;
}

TEST(Verify, FindsNothingWrongWithAWholeScene) {
  const TempFolder folder;
  const SceneDescription scene = made::write_scene_of(folder / "scene.xml", two_cells());
  const VerifyResult r = verify_scene(folder / "scene.xml", 2);
  EXPECT_EQ(all_faults(folder / "scene.xml"), "");
  EXPECT_EQ(r.cells, 2u);
  EXPECT_EQ(r.bytes, scene.cells[0].bytes + scene.cells[1].bytes);
}

/// Damages one byte of a stored chunk: looks for bytes that the dataset is known to hold.
void flip_byte_of(const std::filesystem::path& path, const std::string& held) {
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const std::size_t at = bytes.find(held);
  ASSERT_NE(at, std::string::npos);
  file.seekp(std::streamoff(at)).put(char(bytes[at] ^ 0x10));
}

TEST(Verify, NamesEveryDamagedDataset) {
  const TempFolder folder;
  const std::vector<Shard> shards = two_cells();
  made::write_scene_of(folder / "scene.xml", shards);
  const auto first_voxels = [](const BrickLevel& level) {
    std::string rgb;
    for (std::size_t v = 0; v < 8; ++v)
      rgb.append(level.rgba.begin() + std::ptrdiff_t(4 * v), level.rgba.begin() + std::ptrdiff_t(4 * v + 3));
    return rgb;
  };
  flip_byte_of(folder / "shards/left.h5", first_voxels(shards[0].levels[0]));
  flip_byte_of(folder / "shards/left.h5", first_voxels(shards[0].levels[1]));
  flip_byte_of(folder / "shards/right.h5", first_voxels(shards[1].levels[0]));
  const VerifyResult r = verify_scene(folder / "scene.xml", 2);
  ASSERT_EQ(r.faults.size(), 3u) << all_faults(folder / "scene.xml");
  EXPECT_NE(r.faults[0].find("left.h5: /lod_0/rgb: row 0: the checksum is wrong"), std::string::npos);
  EXPECT_NE(r.faults[1].find("left.h5: /lod_1/rgb: row 0: the checksum is wrong"), std::string::npos);
  EXPECT_NE(r.faults[2].find("right.h5: /lod_0/rgb: row 0: the checksum is wrong"), std::string::npos);
}

TEST(Verify, NamesAShardThatIsMissing) {
  const TempFolder folder;
  made::write_scene_of(folder / "scene.xml", two_cells());
  std::filesystem::remove(folder / "shards/left.h5");
  EXPECT_NE(all_faults(folder / "scene.xml").find("left.h5: no such file"), std::string::npos);
}

TEST(Verify, SeesThatAShardIsOfAnotherBake) {
  const TempFolder folder;
  std::vector<Shard> shards = two_cells();
  made::write_scene_of(folder / "scene.xml", shards);
  shards[0].header.fingerprint.lo ^= 1;
  shards[0].header.triangles += 1;
  write_shard(folder / "shards/left.h5", shards[0], {});
  const std::string faults = all_faults(folder / "scene.xml");
  EXPECT_NE(faults.find("left.h5: fingerprint: differs from scene.xml"), std::string::npos) << faults;
  EXPECT_NE(faults.find("left.h5: triangles: differ from scene.xml"), std::string::npos) << faults;
}

TEST(Verify, SeesVoxelsThatDoNotAddUpToTheContentHash) {
  const TempFolder folder;
  std::vector<Shard> shards = two_cells();
  shards[1].levels[0].rgba[0] ^= 1;
  made::write_scene_of(folder / "scene.xml", shards);
  const std::string faults = all_faults(folder / "scene.xml");
  EXPECT_NE(faults.find("right.h5: /lod_0: the voxels are not those"), std::string::npos) << faults;
}

TEST(Verify, SeesCellsThatOverlapOrShareTheirName) {
  const TempFolder folder;
  std::vector<Shard> shards = two_cells();
  shards[1].header.lattice_min = {24, 0, 16};
  shards[1].header.cell = "left";
  made::write_scene_of(folder / "scene.xml", shards);
  const std::string faults = all_faults(folder / "scene.xml");
  EXPECT_NE(faults.find("scene.xml: left: overlaps cell left"), std::string::npos) << faults;
  EXPECT_NE(faults.find("another cell has the same name"), std::string::npos) << faults;
  EXPECT_NE(faults.find("another cell has the same TreeFile"), std::string::npos) << faults;
}

TEST(Verify, NeedsASceneThatCanBeRead) {
  const TempFolder folder;
  EXPECT_THROW(verify_scene(folder / "absent.xml", 1), InputError);
}

}  // namespace
}  // namespace gigabake
