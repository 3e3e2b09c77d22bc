#include "worker/tiles/tile_store.h"

#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <thread>

#include "../glb_scene.h"
#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "format/source/classes/source_classes.h"
#include "format/source/tile_hash.h"
#include "kernels/cpu/bake_cell.h"
#include "tests/format/system/small_disk.h"
#include "worker/pipeline/cell_loader.h"
#include "worker/pipeline/cell_parameters.h"
#include "worker/scan/scan_tile.h"
#include "worker/tiles/tile_gatherer.h"

namespace gigabake {
namespace {

namespace fs = std::filesystem;

/// 32,768 triangles of textured ground, 128 m wide, in cells of 32 m. The memory limit is 0, so every tile counts as
/// large.
class TileStoreTest : public testing::Test {
 protected:
  TileStoreTest() {
    parameters.voxel_size_m = 0.25;
    parameters.cell_voxels = 128;
    write(rolling_ground(128, 0, 0));
  }

  void write(GlbMesh mesh) {
    mesh.image = checkered_png(64);
    write_glb(folder.path() / "ground.glb", mesh);
    sources = sources_of(folder.path(), {"ground.glb"});
  }

  /// Replaces values in the binary part only, because JSON has no infinite numbers: the accessor's bounds stay
  /// unchanged.
  void replace_in_file(float mark, float value) const {
    std::ifstream in(folder.path() / "ground.glb", std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const std::string from(reinterpret_cast<const char*>(&mark), 4), to(reinterpret_cast<const char*>(&value), 4);
    int count = 0;
    for (std::size_t at = 0; (at = bytes.find(from, at)) != std::string::npos; ++count) bytes.replace(at, 4, to);
    ASSERT_EQ(count, 2);
    std::ofstream(folder.path() / "ground.glb", std::ios::binary) << bytes;
  }

  Hash128 hash() const { return tile_hash(sources.tiles[0], sources.root); }
  fs::path scratch() const { return folder.path() / "scratch"; }
  TileStore store() const { return {sources, parameters, {scratch(), 0}, 2}; }
  fs::path clusters() const { return scratch() / ("t_" + hash().hex() + ".clusters"); }

  CellJob job_at(std::int64_t x, std::int64_t y) const {
    CellJob job;
    job.name = "cell";
    job.lattice_min = {x, y, -64};
    job.cell_voxels = 128;
    job.tiles = {0};
    job.tile_sources = {hash()};
    return job;
  }

  std::vector<Hash128> bake(std::int64_t x, std::int64_t y, TileScratch where) const {
    const CellJob job = job_at(x, y);
    CellLoader loader(sources, parameters, 0, 2, std::move(where));
    const LoadedCell cell = loader.load(job);
    return kernels::bake_cell(cell.input(), cell_parameters(job, parameters, 0), callers_thread()).content_hash;
  }

  /// Returns the names of the folder's files except for lock files.
  std::vector<std::string> left() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(scratch()))
      if (entry.path().extension() != ".lock") names.push_back(entry.path().filename().string());
    return names;
  }

  ScratchFolder folder;
  BakeParameters parameters;
  SceneSources sources;
};

TEST_F(TileStoreTest, CellsHaveTheSameBitsFromScratch) {
  int baked = 0;
  for (std::int64_t y = -128; y < 640; y += 256)
    for (std::int64_t x = -128; x < 640; x += 128) {
      const std::vector<Hash128> from_file = bake(x, y, {});
      EXPECT_EQ(bake(x, y, {scratch(), 0}), from_file) << x << ' ' << y;
      baked += !from_file.empty();
    }
  EXPECT_GT(baked, 6);
  EXPECT_EQ(left().size(), 2u) << "the clusters and the texture";
}

TEST_F(TileStoreTest, CellsHaveTheSameBitsFromScratchWithVertexNormals) {
  GlbMesh mesh = rolling_ground(128, 0, 0);
  for (std::size_t v = 0; v < mesh.position.size() / 3; ++v)
    mesh.normal.insert(mesh.normal.end(), {float(v % 7) / 20, 1, float(v % 5) / 10});
  const std::vector<Hash128> without = bake(128, 128, {});
  write(mesh);
  const std::vector<Hash128> with = bake(128, 128, {});
  EXPECT_EQ(bake(128, 128, {scratch(), 0}), with);
  EXPECT_NE(with, without);
}

TEST_F(TileStoreTest, CellsHaveTheSameBitsFromScratchWithNormalMaps) {
  GlbMesh mesh = rolling_ground(128, 0, 0);
  const std::vector<Hash128> without = bake(128, 128, {});
  for (const std::string map :
       {R"({"index":0})", R"({"index":0,"extensions":{"KHR_texture_transform":{"scale":[2,3]}}})"}) {
    mesh.material = R"({"normalTexture":)" + map + "}";
    write(mesh);
    const std::vector<Hash128> with = bake(128, 128, {});
    EXPECT_EQ(bake(128, 128, {scratch(), 0}), with);
    EXPECT_NE(with, without);
  }
}

TEST_F(TileStoreTest, CellsHaveTheSameBitsFromScratchWithTexturesOfIds) {
  const std::vector<Hash128> without = bake(128, 128, {});
  GlbMesh mesh = rolling_ground(128, 0, 0);
  mesh.extensions = R"({"EXT_mesh_features":{"featureIds":[{"featureCount":65536,"texture":)"
                    R"({"index":0,"channels":[1],"extensions":{"KHR_texture_transform":{"scale":[2,3]}}}}]}})";
  write(mesh);
  parameters.classes = true;
  std::vector<Hash128> before = without;
  for (const std::int64_t add : {0, 5}) {
    SourceClasses classes;
    classes.ids = ClassIds{{}, 0, {}, add};
    sources.tiles[0].classes = std::make_shared<SourceClasses>(classes);
    const std::vector<Hash128> from_file = bake(128, 128, {});
    EXPECT_EQ(bake(128, 128, {scratch(), 0}), from_file);
    EXPECT_NE(from_file, before);
    before = from_file;
  }
}

/// A bake without normals must not find the scratch file of a bake with normals, and conversely.
TEST_F(TileStoreTest, ScratchFilesOfBakesWithAndWithoutNormalsDiffer) {
  GlbMesh mesh = rolling_ground(128, 0, 0);
  mesh.normal.assign(mesh.position.size(), 0.5f);
  write(mesh);
  bake(128, 128, {scratch(), 0});
  const std::size_t files = left().size();
  parameters.normals = false;
  bake(128, 128, {scratch(), 0});
  EXPECT_EQ(left().size(), files + 1);
}

TEST_F(TileStoreTest, ATileIsReadOnce) {
  const std::vector<Hash128> from_file = bake(0, 0, {});
  const Hash128 as_it_was = hash();
  store().load(0, as_it_was);
  fs::remove(folder.path() / "ground.glb");
  const auto tile = store().load(0, as_it_was);
  EXPECT_EQ(tile->images().size(), 1u);
  EXPECT_EQ(tile->whole(0)->index.size(), 3u * 32768);
  EXPECT_LT(tile->bytes(), 200'000u);
}

TEST_F(TileStoreTest, ASmallTileStaysInMemory) {
  const TileStore roomy(sources, parameters, {scratch(), std::uint64_t(1) << 30}, 2);
  EXPECT_FALSE(roomy.may_be_large(0));
  EXPECT_EQ(roomy.load(0, hash())->whole(0)->index.size(), 3u * 32768);
  EXPECT_FALSE(fs::exists(scratch()));
  EXPECT_EQ(scratch_in(scratch(), 0).max_tile_bytes, std::numeric_limits<std::uint64_t>::max());
}

TEST_F(TileStoreTest, AScanIsTheSameFromScratchAndInParts) {
  const ThreadPool pool(2);
  const TileStore clusters_on_disk = store(), nowhere(sources, parameters, {{}, 0}, 2);
  const TileScan a = scan_tile(sources, 0, parameters, pool), parts = scan_tile(sources, 0, parameters, pool, &nowhere);
  EXPECT_FALSE(fs::exists(scratch()));
  const TileScan b = scan_tile(sources, 0, parameters, pool, &clusters_on_disk);
  EXPECT_EQ(a.error + b.error + parts.error, "");
  EXPECT_EQ(to_bytes(a), to_bytes(b));
  EXPECT_EQ(to_bytes(a), to_bytes(parts));
  EXPECT_EQ(left().size(), 1u);
}

TEST_F(TileStoreTest, AScanIsTheSameOfMeshesThatCannotBeBounded) {
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e30f}) {
    constexpr float mark = 0.1234567f;
    GlbMesh mesh = rolling_ground(128, 0, 0);
    mesh.position[3 * 700 + 1] = mesh.position[3 * 4000 + 1] = mark;
    write(mesh);
    replace_in_file(mark, wrong);
    const ThreadPool pool(2);
    const TileStore clusters_on_disk = store(), nowhere(sources, parameters, {{}, 0}, 2);
    const TileScan a = scan_tile(sources, 0, parameters, pool),
                   b = scan_tile(sources, 0, parameters, pool, &clusters_on_disk),
                   parts = scan_tile(sources, 0, parameters, pool, &nowhere);
    EXPECT_EQ(a.error, b.error);
    EXPECT_EQ(to_bytes(a), to_bytes(b)) << wrong;
    EXPECT_EQ(to_bytes(a), to_bytes(parts)) << wrong;
    EXPECT_GT(a.non_finite + a.too_far, 0u);
    EXPECT_EQ(bake(0, 0, {scratch(), 0}), bake(0, 0, {})) << wrong;
  }
}

TEST_F(TileStoreTest, AFileThatIsCutCountsAsNone) {
  const std::vector<Hash128> right = bake(0, 0, {});
  store().load(0, hash());
  const std::uint64_t whole = fs::file_size(clusters());
  for (const std::uint64_t size : {std::uint64_t(0), std::uint64_t(39), whole / 2, whole - 1}) {
    fs::resize_file(clusters(), size);
    EXPECT_EQ(bake(0, 0, {scratch(), 0}), right) << size;
    EXPECT_EQ(fs::file_size(clusters()), whole);
  }
}

TEST_F(TileStoreTest, AChangedImageIsNamed) {
  store().load(0, hash());
  const auto tile = store().load(0, hash());
  EXPECT_EQ(tile->encoded(0).bytes, checkered_png(64));
  std::fstream file(clusters(), std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(std::streamoff(tile->images()[0].stored.offset + 40));
  file.put('!');
  file.close();
  EXPECT_THROW(tile->encoded(0), IoError);
}

TEST_F(TileStoreTest, AChangedByteIsNamedAndTheNextTryMakesTheFileAnew) {
  const std::vector<Hash128> right = bake(0, 0, {});
  store().load(0, hash());
  std::fstream file(clusters(), std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(100);
  file.put('!');
  file.close();
  const auto tile = store().load(0, hash());
  try {
    for (std::size_t p = 0; p < tile->primitives().size(); ++p) tile->whole(p);
    FAIL() << "took other triangles";
  } catch (const IoError& e) {
    EXPECT_NE(std::string(e.what()).find("differs from the data written"), std::string::npos) << e.what();
  }
  EXPECT_TRUE(left().empty());
  EXPECT_EQ(bake(0, 0, {scratch(), 0}), right);
}

TEST_F(TileStoreTest, ARankThatMetAChangedByteReadsTheTileAnewAtItsNextTry) {
  const std::vector<Hash128> right = bake(0, 0, {});
  const CellJob job = job_at(0, 0);
  CellLoader loader(sources, parameters, std::uint64_t(1) << 28, 2, {scratch(), 0});
  const LoadedCell first = loader.load(job);
  std::fstream file(clusters(), std::ios::in | std::ios::out | std::ios::binary);
  const TileCluster* near = nullptr;
  for (const TileCluster& c : first.tiles[0]->primitives()[0].clusters)
    if (c.bounds.low[0] > 2 && c.bounds.high[0] < 30 && c.bounds.low[2] > -30 && c.bounds.high[2] < -2) near = &c;
  ASSERT_NE(near, nullptr) << "no cluster lies within the cell";
  file.seekp(std::streamoff(near->stored.offset + 50));
  file.put('!');
  file.close();
  EXPECT_THROW(loader.load(job), IoError);
  const LoadedCell again = loader.load(job);
  EXPECT_EQ(kernels::bake_cell(again.input(), cell_parameters(job, parameters, 0), callers_thread()).content_hash,
            right);
}

TEST_F(TileStoreTest, ATileThatChangedSinceItsScanLeavesNothing) {
  Hash128 scanned = hash();
  scanned.lo ^= 1;
  EXPECT_THROW(store().load(0, scanned), InputError);
  EXPECT_TRUE(left().empty());
}

TEST_F(TileStoreTest, ADiskThatFillsUpIsNamedAndNothingHalfWrittenStays) {
  for (const std::uint64_t bytes : {0, 1000, 300'000}) {
    const Hash128 expected = hash();
    const TileStore full = store();
    const SmallDisk end(bytes);
    try {
      full.load(0, expected);
      ADD_FAILURE() << "wrote beyond the end";
    } catch (const IoError& e) {
      EXPECT_NE(std::string(e.what()).find("cannot write"), std::string::npos) << e.what();
    }
    EXPECT_TRUE(left().empty());
  }
}

TEST_F(TileStoreTest, AFolderThatCannotBeMadeIsNamed) {
  std::ofstream(scratch()) << "a file";
  try {
    store().load(0, hash());
    FAIL() << "wrote into a file";
  } catch (const IoError& e) {
    EXPECT_NE(std::string(e.what()).find("scratch"), std::string::npos);
  }
}

TEST_F(TileStoreTest, SeveralRanksThatWantATileMakeOneFile) {
  const Hash128 expected = hash();
  std::vector<std::thread> ranks;
  for (int rank = 0; rank < 5; ++rank)
    ranks.emplace_back([&] {
      const auto tile = store().load(0, expected);
      EXPECT_EQ(tile->whole(0)->index.size(), 3u * 32768);
    });
  for (std::thread& rank : ranks) rank.join();
  EXPECT_EQ(left().size(), 1u);
}

TEST(TilePrimitiveCollector, MakesTheFolderWhenATileTurnsOutToBeLarge) {
  const ScratchFolder folder;
  const ThreadPool pool(1);
  const fs::path file = folder.path() / "not/yet/t_0.clusters";
  TilePrimitiveCollector gatherer("tile.glb", {100, file}, pool);
  Primitive mesh;
  mesh.position.assign(90, 1.0f);
  mesh.index.assign(30, 7);
  gatherer.take(std::move(mesh));
  EXPECT_TRUE(gatherer.is_on_scratch());
  TileMesh rest;
  rest.primitives.resize(1);
  rest.materials.resize(1);
  const TileDirectory directory = gatherer.finish(std::move(rest));
  ASSERT_EQ(directory.primitives.size(), 1u);
  EXPECT_EQ(directory.primitives[0].triangles, 10u);
  EXPECT_NE(TileFile::open(file), nullptr);
}

TEST(TilePrimitiveCollector, RefusesWhatMemoryCannotHoldWhereThereIsNoScratch) {
  set_memory_limit(1 << 20);
  const ThreadPool pool(1);
  TilePrimitiveCollector gatherer("tile.glb", {0, {}}, pool);
  Primitive mesh;
  mesh.position.assign(1 << 19, 0.0f);
  EXPECT_THROW(gatherer.take(std::move(mesh)), InputError);
  set_memory_limit(0);
}

}  // namespace
}  // namespace gigabake
