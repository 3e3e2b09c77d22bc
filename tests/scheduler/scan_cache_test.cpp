#include "scheduler/journal/scan_cache.h"

#include <fcntl.h>
#include <fstream>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <thread>

#include "format/source/tile_hash.h"
#include "made_bake.h"
#include "scheduler/plan/plan.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

class ScanCacheTest : public ::testing::Test {
 protected:
  /// Makes two tiles with a buffer each and a common image; tile 1 is placed twice.
  void SetUp() override {
    write_tile("a");
    write_tile("b");
    write_text(folder / "scene/skin.png", "texels");
    sources.root = folder / "scene";
    for (const char* name : {"a", "b", "b"}) {
      TileRef tile;
      tile.name = std::string(name) + ".gltf";
      tile.path = sources.root / tile.name;
      tile.kind = ContentKind::gltf;
      tile.scene_from_tile.m[0][3] = double(sources.tiles.size());
      sources.tiles.push_back(tile);
    }
    parameters.voxel_size_m = 0.5;
  }
  void write_tile(const std::string& name) const {
    write_text(folder / "scene" / (name + ".gltf"), R"({"asset": {"version": "2.0"}, "buffers": [{"uri": ")" + name +
                                                        R"(%20.bin"}], "images": [{"uri": "skin.png"}]})");
    write_text(folder / "scene" / (name + " .bin"), "positions of " + name);
  }
  /// Returns a result like that of scan_tile(). If `settled`, all files count as files that have not changed for a long
  /// time.
  TileScan scan(std::uint32_t tile, bool settled = true) const {
    TileIdentity identity = identify_tile(sources.tiles[tile], sources.root);
    TileScan s;
    s.tile = tile;
    s.columns = {{tile, 0, 0, 8, 5}};
    s.triangles = 5;
    s.spacing_m = 0.125;
    s.source = identity.hash;
    s.files = std::move(identity.files);
    for (StampedFile& file : s.files) file.settled = file.settled || settled;
    return s;
  }
  void save(bool settled = true) const {
    save_scan_cache(path(), sources, parameters, std::vector{scan(0, settled), scan(1, settled), scan(2, settled)});
  }
  /// Returns a digit per tile, for example "101": 1 for a tile that needs no scan.
  std::string found() const {
    std::string out;
    for (const auto& s : ScanCache(path()).find_all(sources, parameters, 2)) out += s ? '1' : '0';
    return out;
  }
  std::filesystem::path path() const { return folder / "survey.cache"; }

  TestFolder folder;
  SceneSources sources;
  BakeParameters parameters;
};

void expect_equal(const TileScan& a, const TileScan& b) {
  EXPECT_EQ(a.tile, b.tile);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.spacing_m, b.spacing_m);
  EXPECT_EQ(a.bounds, b.bounds);
  ASSERT_EQ(a.columns.size(), b.columns.size());
  EXPECT_EQ(a.columns[0].column_x, b.columns[0].column_x);
}

TEST_F(ScanCacheTest, GivesBackTheScansOfFilesThatNobodyTouched) {
  save();
  EXPECT_EQ(found(), "111");
  const ScanCache cache(path());
  for (std::uint32_t tile = 0; tile < 3; ++tile)
    expect_equal(cache.find(sources, tile, parameters).value(), scan(tile));
}

TEST_F(ScanCacheTest, FindsATileUnderAnotherNumber) {
  save();
  std::swap(sources.tiles[0], sources.tiles[2]);
  EXPECT_EQ(ScanCache(path()).find(sources, 2, parameters)->tile, 2u);
}

TEST_F(ScanCacheTest, AChangedFileOfATileAsksForAScan) {
  save();
  write_text(folder / "scene/b .bin", "positions of c");
  EXPECT_EQ(found(), "100");
  save();
  EXPECT_EQ(found(), "111");
  write_text(folder / "scene/skin.png", "others");
  EXPECT_EQ(found(), "000");
}

TEST_F(ScanCacheTest, AFileThatVanishesOrAppearsAsksForAScan) {
  std::filesystem::remove(folder / "scene/skin.png");
  save();
  EXPECT_EQ(found(), "111");
  write_text(folder / "scene/skin.png", "");
  EXPECT_EQ(found(), "000");
  save();
  std::filesystem::remove(folder / "scene/a .bin");
  EXPECT_EQ(found(), "011");
}

TEST_F(ScanCacheTest, ALinkThatLeadsElsewhereAsksForAScan) {
  write_text(folder / "scene/old.png", "same");
  write_text(folder / "scene/new.png", "size");
  std::filesystem::remove(folder / "scene/skin.png");
  std::filesystem::create_symlink("old.png", folder / "scene/skin.png");
  save();
  EXPECT_EQ(found(), "111");
  std::filesystem::remove(folder / "scene/skin.png");
  std::filesystem::create_symlink("new.png", folder / "scene/skin.png");
  EXPECT_EQ(found(), "000");
}

TEST_F(ScanCacheTest, APathThroughAFolderThatIsNotThereIsNeverTrusted) {
  write_text(folder / "scene/a.gltf", R"({"asset": {"version": "2.0"}, "images": [{"uri": "absent/../skin.png"}]})");
  const TileIdentity identity = identify_tile(sources.tiles[0], sources.root);
  ASSERT_EQ(identity.files.size(), 2u);
  EXPECT_FALSE(identity.files[1].settled);
}

TEST_F(ScanCacheTest, AnEditThatSetsSizeAndTimeBackAsksForAScan) {
  save();
  struct stat before {};
  ASSERT_EQ(::stat((folder / "scene/a .bin").c_str(), &before), 0);
  write_text(folder / "scene/a .bin", "POSITIONS of a");
  const timespec times[2] = {before.st_atim, before.st_mtim};
  ASSERT_EQ(::utimensat(AT_FDCWD, (folder / "scene/a .bin").c_str(), times, 0), 0);
  EXPECT_EQ(found(), "011");
}

TEST_F(ScanCacheTest, ATouchedFileOfEqualContentIsScannedAgainAndGivesTheSameFingerprint) {
  save();
  const TileScan before = scan(0);
  const timespec times[2] = {{1000, 0}, {1000, 0}};
  ASSERT_EQ(::utimensat(AT_FDCWD, (folder / "scene/a.gltf").c_str(), times, 0), 0);
  EXPECT_EQ(found(), "011");
  EXPECT_EQ(make_plan({scan(0), scan(1), scan(2)}, sources, parameters).jobs[0].fingerprint,
            make_plan({before, scan(1), scan(2)}, sources, parameters).jobs[0].fingerprint);
}

TEST_F(ScanCacheTest, AMovedTileOrAnotherLatticeAsksForAScan) {
  save();
  sources.tiles[1].scene_from_tile.m[2][3] += 1e-9;
  EXPECT_EQ(found(), "101");
  sources.tiles[1].scene_from_tile.m[2][3] = 0;
  sources.tiles[0].gltf_up = UpAxis::x;
  EXPECT_EQ(found(), "011");
  sources.tiles[0].gltf_up = UpAxis::y;
  parameters.normals = false;  // not a parameter of scans
  parameters.mip = MipFilter::box;
  EXPECT_EQ(found(), "111");
  for (const auto& change : std::vector<void (*)(BakeParameters&)>{
           [](BakeParameters& p) { p.voxel_size_m = 0.25; }, [](BakeParameters& p) { p.lattice_origin_m[1] = 1; },
           [](BakeParameters& p) { p.cell_voxels = 512; }, [](BakeParameters& p) { p.surface = SurfaceRule::thin; }}) {
    const BakeParameters before = parameters;
    change(parameters);
    EXPECT_EQ(found(), "000");
    parameters = before;
  }
}

TEST_F(ScanCacheTest, DoesNotKeepWhatWasReadWithinTwoSecondsOfAWrite) {
  save(false);
  EXPECT_EQ(found(), "000");
  EXPECT_EQ(ScanCache(path()).size(), 0u);
}

TEST_F(ScanCacheTest, KeepsWhatWasReadLaterThanThat) {
  std::this_thread::sleep_for(std::chrono::milliseconds(2100));
  save(false);
  EXPECT_EQ(found(), "111");
}

TEST_F(ScanCacheTest, DoesNotKeepTilesThatCouldNotBeRead) {
  TileScan failed = scan(0);
  failed.error = "cannot be read";
  save_scan_cache(path(), sources, parameters, std::vector{failed, scan(1)});
  EXPECT_EQ(found(), "010");
}

TEST_F(ScanCacheTest, OfAFileThatIsAbsentCutOrForeignIsEmpty) {
  EXPECT_EQ(found(), "000");
  save();
  const std::string whole = read_text(path());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    write_text(path(), whole.substr(0, size));
    ASSERT_EQ(ScanCache(path()).size(), 0u) << size;
  }
  write_text(path(), whole + "x");
  EXPECT_EQ(found(), "000");
  write_text(path(), "<?xml version=\"1.0\"?>" + whole);
  EXPECT_EQ(found(), "000");
  std::filesystem::remove(path());
  std::filesystem::create_directory(path());
  EXPECT_EQ(found(), "000");
}

/// 2026-11-25: ranks with other options saved their scans under the keys of rank 0's options.
TEST_F(ScanCacheTest, OfAnEarlierProgramIsEmpty) {
  save();
  ASSERT_EQ(found(), "111");
  std::fstream file(path(), std::ios::in | std::ios::out | std::ios::binary);
  const std::uint64_t before = scan_version;
  file.seekp(16).write(reinterpret_cast<const char*>(&before), sizeof before);
  file.close();
  EXPECT_EQ(found(), "000");
}

TEST_F(ScanCacheTest, WithFlippedBytesIsEmpty) {
  save();
  const std::string whole = read_text(path());
  const test::RandomSeed seed;
  std::mt19937_64 random(seed);
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = whole;
    for (std::uint64_t i = 1 + random() % 4; i-- > 0;) damaged[random() % damaged.size()] ^= char(1 + random() % 255);
    if (damaged == whole) continue;
    write_text(path(), damaged);
    ASSERT_EQ(ScanCache(path()).size(), 0u);
  }
}

TEST(FileStamp, IsSettledTwoSecondsAfterTheLastOfItsTimes) {
  constexpr std::int64_t s = 1'000'000'000;
  EXPECT_TRUE(is_settled({1, 5 * s, 6 * s, 9}, 8 * s));
  EXPECT_FALSE(is_settled({1, 5 * s, 6 * s, 9}, 8 * s - 1));
  EXPECT_FALSE(is_settled({1, 7 * s, 6 * s, 9}, 8 * s));
  EXPECT_FALSE(is_settled({1, 5 * s, 100 * s, 9}, 8 * s)) << "a change in the future shows that clocks differ";
  EXPECT_TRUE(is_settled({}, 0));
}

TEST(FileStamp, TellsAbsenceFromIgnorance) {
  const TestFolder folder;
  EXPECT_EQ(stamp_of(folder / "absent"), FileStamp{});
  EXPECT_EQ(stamp_of(folder.path()), FileStamp{});
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(stamp_of(folder / "pipe"), FileStamp{});
  std::filesystem::create_symlink("loop", folder / "loop");
  EXPECT_EQ(stamp_of(folder / "loop"), std::nullopt);
  EXPECT_FALSE(stamped("loop", folder / "loop").settled);
  EXPECT_TRUE(stamped("absent", folder / "absent").settled);
}

}  // namespace
}  // namespace gigabake
