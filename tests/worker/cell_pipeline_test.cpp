#include "worker/pipeline/cell_pipeline.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <thread>

#include "core/base/error.h"
#include "format/shard/levels/content_hash.h"
#include "format/shard/shard.h"
#include "format/source/tile_hash.h"
#include "glb_scene.h"
#include "worker/scan/scan_tile.h"

namespace gigabake {
namespace {

/// A fixture with ground of two adjacent textured tiles, in cells of 64 voxels.
class CellPipelineTest : public testing::Test {
 protected:
  CellPipelineTest() {
    parameters.voxel_size_m = 0.25;
    parameters.cell_voxels = 64;
    for (int i : {0, 1}) {
      GlbMesh mesh = rolling_ground(32, 32.0 * i, 0);
      mesh.image = checkered_png(64);
      write_glb(folder.path() / ("tile" + std::to_string(i) + ".glb"), mesh);
    }
    sources = sources_of(folder.path(), {"tile0.glb", "tile1.glb"});
  }

  /// Returns one job per column that the tiles touch; the ground's height fits one cell.
  std::vector<CellJob> jobs() const {
    const ThreadPool pool(1);
    std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::uint32_t>> columns;
    for (std::uint32_t t = 0; t < sources.tiles.size(); ++t)
      for (const ColumnExtent& c : scan_tile(sources, t, parameters, pool).columns)
        columns[{c.column_x, c.column_y}].push_back(t);
    std::vector<CellJob> out;
    for (const auto& [column, tiles] : columns) {
      CellJob job;
      job.id = std::uint32_t(out.size());
      job.name = "c_" + std::to_string(column.first) + "_" + std::to_string(column.second) + "_0";
      job.lattice_min = {column.first * 64, column.second * 64, -32};
      job.cell_voxels = 64;
      job.tiles = tiles;
      job.fingerprint = {job.id + 1, 42};
      out.push_back(job);
    }
    return out;
  }

  /// Returns the job of the overview above the cells. The cells' stacks begin at voxels that are no multiples of the
  /// overview's bricks.
  static CellJob overview_of(const std::vector<CellJob>& cells) {
    CellJob job;
    job.id = std::uint32_t(cells.size());
    job.name = "p4_-4_-4_-4";
    job.lattice_min = {-256, -256, -256};
    job.cell_voxels = 512;
    job.first_lod = 1;
    job.copied_lods = 3;
    job.fingerprint = {7, 42};
    return job;
  }

  /// Sets the hashes of the tiles' sources, as the plan does.
  void know_sources(std::vector<CellJob>& cells) const {
    for (CellJob& job : cells)
      for (const std::uint32_t tile : job.tiles)
        job.tile_sources.push_back(tile_hash(sources.tiles[tile], sources.root));
  }

  std::vector<CellReport> run(const std::vector<CellJob>& cells, const std::string& out, int threads = 2,
                              std::uint64_t memory = 0, std::optional<int> device = {}) const {
    CellPipeline pipeline(sources, parameters, {threads, memory, folder.path() / out, device});
    return bake_all(pipeline, cells);
  }

  static Hash128 hash_of(const std::vector<CellReport>& reports) {
    Hash128 sum;
    for (const CellReport& r : reports)
      for (const Hash128& h : r.cell.content_hash) sum += h;
    return sum;
  }

  ScratchFolder folder;
  BakeParameters parameters;
  SceneSources sources;
};

TEST_F(CellPipelineTest, ReportsEveryCellOnce) {
  const auto cells = jobs();
  ASSERT_GT(cells.size(), 4u);
  const auto reports = run(cells, "out");
  ASSERT_EQ(reports.size(), cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    EXPECT_EQ(reports[i].id, cells[i].id);
    EXPECT_EQ(reports[i].outcome, CellOutcome::baked) << reports[i].error;
    EXPECT_GT(reports[i].peak_bytes, 0u);
  }
}

TEST_F(CellPipelineTest, BakesOnTheCpuAndSaysSoWhereTheGpuFails) {
  const auto cells = jobs();
  constexpr int no_such_device = 999;
  const auto reports = run(cells, "gpu", 2, 0, no_such_device);
  ASSERT_EQ(reports.size(), cells.size());
  for (const CellReport& r : reports) {
    EXPECT_EQ(r.outcome, CellOutcome::baked) << r.error;
    EXPECT_FALSE(r.on_device);
    EXPECT_NE(r.note.find("CPU"), std::string::npos) << r.note;
  }
  EXPECT_EQ(hash_of(reports), hash_of(run(cells, "cpu")));
}

TEST_F(CellPipelineTest, PublishesAShardThatReadsBackAsReported) {
  const auto cells = jobs();
  for (const CellReport& r : run(cells, "out")) {
    ASSERT_EQ(r.outcome, CellOutcome::baked) << r.error;
    const auto path = folder.path() / "out" / r.cell.file;
    const Shard shard = read_shard(path);
    EXPECT_EQ(r.cell.file, shard_path(cells[r.id]).generic_string());
    EXPECT_EQ(r.cell.bytes, std::filesystem::file_size(path));
    EXPECT_EQ(r.cell.content_hash, content_hash(shard));
    EXPECT_EQ(shard.header.content_hash, content_hash(shard));
    EXPECT_EQ(r.cell.lods, 4u);
    ASSERT_EQ(r.cell.voxels.size(), 4u);
    EXPECT_GT(r.cell.voxels[0], r.cell.voxels[3]);
    EXPECT_EQ(shard.header.lattice_min, cells[r.id].lattice_min);
    EXPECT_EQ(shard.header.fingerprint, cells[r.id].fingerprint);
    EXPECT_GT(r.cell.triangles, 0u);
  }
}

TEST_F(CellPipelineTest, BakesTheSameVoxelsForAnyMemoryBudgetAndThreads) {
  const auto cells = jobs();
  const Hash128 expected = hash_of(run(cells, "reference"));
  for (const auto& [threads, memory] :
       {std::pair(1, std::uint64_t(1)), {3, std::uint64_t(1) << 20}, {2, std::uint64_t(1) << 34}, {16, 0}}) {
    const auto reports = run(cells, "out" + std::to_string(threads), threads, memory);
    EXPECT_EQ(hash_of(reports), expected) << threads << " threads, " << memory << " bytes";
  }
}

TEST_F(CellPipelineTest, TakesOverAWholeShardOfTheSameFingerprint) {
  const auto cells = jobs();
  const auto first = run(cells, "out");
  const auto path = folder.path() / "out" / shard_path(cells[0]);
  const auto written = std::filesystem::last_write_time(path);
  const auto second = run(cells, "out");
  EXPECT_EQ(std::filesystem::last_write_time(path), written);
  ASSERT_EQ(second.size(), first.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(second[i].cell.voxels, first[i].cell.voxels);
    EXPECT_EQ(second[i].cell.content_hash, first[i].cell.content_hash);
    EXPECT_EQ(second[i].cell.bytes, first[i].cell.bytes);
    EXPECT_EQ(second[i].cell.triangles, first[i].cell.triangles);
    EXPECT_EQ(second[i].kernel_s, 0);
    EXPECT_EQ(second[i].shard, first[i].shard);
    if (first[i].outcome == CellOutcome::baked) {
      EXPECT_EQ(first[i].shard, stamp_of(folder.path() / "out" / first[i].cell.file));
    }
  }
}

TEST_F(CellPipelineTest, BakesAgainWhatADamagedShardHeld) {
  const auto cells = jobs();
  const Hash128 expected = hash_of(run(cells, "out"));
  const auto path = folder.path() / "out" / shard_path(cells[0]);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  EXPECT_EQ(hash_of(run(cells, "out")), expected);
  EXPECT_NO_THROW(read_shard(path));
}

// 2026-11-22: an edited shard with correct checksums was reused.
TEST_F(CellPipelineTest, BakesAgainAShardThatHasNotTheVoxelsOrTheNameThatItSays) {
  const auto cells = jobs();
  const Hash128 expected = hash_of(run(cells, "out"));
  const auto path = folder.path() / "out" / shard_path(cells[0]);
  const Shard whole = read_shard(path);
  Shard recoloured = whole, renamed = whole, moved = whole;
  recoloured.levels[0].rgba[0] ^= 1;
  renamed.header.cell += "x";
  moved.header.origin = Geodetic{1, 2, 3};
  for (const Shard& edited : {recoloured, renamed, moved}) {
    write_shard(path, edited, {});
    EXPECT_EQ(hash_of(run(cells, "out")), expected);
    const Shard now = read_shard(path);
    EXPECT_EQ(now.levels[0].rgba, whole.levels[0].rgba);
    EXPECT_EQ(now.header.cell, whole.header.cell);
    EXPECT_EQ(now.header.origin, whole.header.origin);
  }
}

// 2026-11-25: an overview read its children's files although this process had written them a moment before.
TEST_F(CellPipelineTest, MakesAnOverviewOfCellsInMemoryAndOfTheirFilesWithTheSameBytes) {
  auto cells = jobs();
  CellJob overview = overview_of(cells);
  for (CellJob& cell : cells) cell.kept_lod = overview.first_lod;
  const std::filesystem::path out = folder.path() / "out", aside = folder.path() / "aside";
  {
    CellPipeline pipeline(sources, parameters, {2, 0, out});
    for (const CellReport& r : bake_all(pipeline, cells)) {
      ASSERT_EQ(r.outcome, CellOutcome::baked) << r.error;
      overview.child_files.push_back(r.cell.file);
    }
    std::filesystem::rename(out / "shards", aside);
    std::filesystem::create_directory(out / "shards");
    const auto reports = bake_all(pipeline, {overview});
    ASSERT_EQ(reports.at(0).outcome, CellOutcome::baked) << "without a file of a cell: " << reports[0].error;
  }
  const Shard of_memory = read_shard(out / shard_path(overview));
  EXPECT_GT(of_memory.levels.front().rgba.size(), 4000u);
  std::filesystem::rename(out / shard_path(overview), aside / "of memory.h5");
  std::filesystem::remove(out / "shards");
  std::filesystem::rename(aside, out / "shards");
  const auto bytes_of = [](const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  constexpr std::uint64_t evicted_at_once = 1 << 10, memory = 32 * evicted_at_once;
  for (const auto& [name, budget] : {std::pair("resumed", std::uint64_t(0)), std::pair("little memory", memory)}) {
    CellPipeline pipeline(sources, parameters, {3, budget, out});
    if (budget != 0) bake_all(pipeline, cells);
    const auto reports = bake_all(pipeline, {overview});
    ASSERT_EQ(reports.at(0).outcome, CellOutcome::baked) << reports[0].error;
    EXPECT_EQ(bytes_of(out / shard_path(overview)), bytes_of(out / "shards/of memory.h5")) << name;
    std::filesystem::remove(out / shard_path(overview));
  }
}

TEST_F(CellPipelineTest, CostsABadTileItsCellsAndFinishesTheOthers) {
  const auto cells = jobs();
  std::ofstream(folder.path() / "tile1.glb", std::ios::binary | std::ios::trunc) << "glTF, but not quite";
  int baked = 0, failed = 0;
  for (const CellReport& r : run(cells, "out")) {
    const bool needs_it = std::ranges::find(cells[r.id].tiles, 1u) != cells[r.id].tiles.end();
    EXPECT_EQ(r.outcome, needs_it ? CellOutcome::refused : CellOutcome::baked) << r.error;
    (needs_it ? failed : baked) += 1;
    EXPECT_EQ(r.error.find("tile1.glb") != std::string::npos, needs_it) << r.error;
    EXPECT_EQ(r.error.find('\n'), std::string::npos);
    EXPECT_EQ(std::filesystem::exists(folder.path() / "out" / shard_path(cells[r.id])), !needs_it);
  }
  EXPECT_GT(baked, 0);
  EXPECT_GT(failed, 0);
}

TEST_F(CellPipelineTest, FailsTheCellsOfATileThatIsNotWhatWasScanned) {
  auto cells = jobs();
  know_sources(cells);
  EXPECT_EQ(hash_of(run(cells, "known")), hash_of(run(jobs(), "unknown")));
  GlbMesh other = rolling_ground(32, 32, 1);
  other.image = checkered_png(64);
  write_glb(folder.path() / "tile1.glb", other);
  int failed = 0;
  for (const CellReport& r : run(cells, "changed")) {
    const bool needs_it = std::ranges::find(cells[r.id].tiles, 1u) != cells[r.id].tiles.end();
    EXPECT_EQ(r.outcome, needs_it ? CellOutcome::refused : CellOutcome::baked) << r.error;
    EXPECT_EQ(r.error.find("tile1.glb: changed while the bake ran; bake again") != std::string::npos, needs_it);
    failed += needs_it;
  }
  EXPECT_GT(failed, 0);
}

TEST_F(CellPipelineTest, TakesATileThatChangedFromItsFileAndNotFromTheCache) {
  CellPipeline pipeline(sources, parameters, {2, 0, folder.path() / "out"});
  const auto bake = [&](std::uint64_t fingerprint) {
    std::vector<CellJob> cells = {jobs()[0]};
    cells[0].fingerprint = {fingerprint, 1};
    know_sources(cells);
    pipeline.submit(cells[0]);
    std::optional<CellReport> report;
    while (!(report = pipeline.poll())) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_EQ(report->outcome, CellOutcome::baked) << report->error;
    return hash_of({*report});
  };
  const Hash128 first = bake(1);
  EXPECT_EQ(bake(2), first);
  GlbMesh other = rolling_ground(32, 0, 1);
  other.image = checkered_png(64);
  write_glb(folder.path() / "tile0.glb", other);
  EXPECT_NE(bake(3), first);
}

TEST_F(CellPipelineTest, TellsOfEveryReport) {
  const auto cells = jobs();
  std::atomic<std::size_t> told{0};
  CellPipeline pipeline(sources, parameters, {2, 0, folder.path() / "out"}, [&told] { ++told; });
  for (const CellJob& job : cells) pipeline.submit(job);
  while (told < cells.size()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  for (std::size_t i = 0; i < cells.size(); ++i) EXPECT_TRUE(pipeline.poll());
}

/// Damage inside an image is found only when the image is decoded. The scan finds a file that is no image, which is
/// then replaced by grey.
TEST_F(CellPipelineTest, NamesTheImageThatItCannotDecode) {
  GlbMesh mesh = rolling_ground(32, 0, 0);
  mesh.image = checkered_png(64);
  for (std::size_t i = mesh.image.size() / 2; i < mesh.image.size() / 2 + 4; ++i) mesh.image[i] ^= 0xff;
  write_glb(folder.path() / "tile0.glb", mesh);
  const auto reports = run(jobs(), "out");
  ASSERT_FALSE(reports.empty());
  EXPECT_EQ(reports[0].outcome, CellOutcome::refused);
  EXPECT_NE(reports[0].error.find("tile0.glb"), std::string::npos) << reports[0].error;
  EXPECT_NE(reports[0].error.find("image"), std::string::npos) << reports[0].error;
}

TEST_F(CellPipelineTest, ReportsACellWithoutVoxelsAsEmptyAndWritesNothing) {
  CellJob job = jobs()[0];
  job.lattice_min[2] = 6400;
  const auto reports = run({job}, "out");
  ASSERT_EQ(reports.size(), 1u);
  EXPECT_EQ(reports[0].outcome, CellOutcome::empty);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "out" / "shards"));
}

// 2026-11-22: a triangle that extends too far caused every cell that it overlaps to fail.
TEST_F(CellPipelineTest, LeavesOutTrianglesThatReachTooFarWhateverTheCell) {
  GlbMesh mesh = rolling_ground(32, 0, 0);
  const auto cells = jobs();
  const Hash128 expected = hash_of(run({cells[0]}, "without"));
  const auto vertex = std::uint32_t(mesh.position.size() / 3);
  for (const float x : {4e6f, -4e6f, 1e30f}) mesh.position.insert(mesh.position.end(), {x, 0, 0});
  for (std::uint32_t far = 0; far < 3; ++far) mesh.index.insert(mesh.index.begin() + 3, {0, 1, vertex + far});
  if (!mesh.uv.empty()) mesh.uv.resize(2 * (std::size_t(vertex) + 3));
  mesh.image = checkered_png(64);
  write_glb(folder.path() / "tile0.glb", mesh);
  EXPECT_EQ(hash_of(run({cells[0]}, "with")), expected);
}

TEST_F(CellPipelineTest, FailsACellThatNamesATileThereIsNot) {
  CellJob job = jobs()[0];
  job.tiles = {77};
  EXPECT_EQ(run({job}, "out")[0].outcome, CellOutcome::failed);
}

TEST_F(CellPipelineTest, EndsWithJobsStillWaiting) {
  const auto cells = jobs();
  CellPipeline pipeline(sources, parameters, {2, 0, folder.path() / "out"});
  for (int round = 0; round < 20; ++round)
    for (const CellJob& job : cells) pipeline.submit(job);
  EXPECT_GT(pipeline.in_flight(), 0u);
}

TEST_F(CellPipelineTest, RefusesAnOutputFolderThatCannotBeMade) {
  std::ofstream(folder.path() / "file") << "in the way";
  EXPECT_THROW(CellPipeline(sources, parameters, {1, 0, folder.path() / "file"}), InputError);
}

}  // namespace
}  // namespace gigabake
