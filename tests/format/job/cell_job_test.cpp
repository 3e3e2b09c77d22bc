#include "format/job/cell_job.h"

#include <gtest/gtest.h>
#include <random>

#include "core/base/error.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

CellJob some_job() {
  return {7, "c_1_-2_0", {1024, -2048, 8}, 1024, {0, 3, 4000000000u}, 123456789012u, {1, 2}, {{3, 4}, {5, 6}, {7, 8}}};
}

CellReport some_report() {
  CellReport r;
  r.id = 9;
  r.outcome = CellOutcome::baked;
  r.error = "one line\twith ä";
  r.cell = {"c", "shards/c.h5", {1, 2, -3}, 64, 4, 5, 6, {7, 8, 9, 10}, {11, 12}, {{13, 14}, {15, 16}}};
  r.read_s = 0.1, r.kernel_s = 1e-300, r.write_s = 3, r.peak_bytes = 1ull << 40;
  r.shard = {5, -6, 7, 8};
  r.levels = {{{1, 2, 3, 4, 5}, 6, 7}, {{0, 0, 0, 0, 1ull << 40}, 8, 9}};
  return r;
}

SourceWarning lost_faces() {
  SourceWarning lost("faces that cannot be used");
  lost.count = 2, lost.of = 10, lost.example = "line 5", lost.is_loss = true;
  return lost;
}

TileScan some_scan() {
  return {5,
          {{-1, 2, -300, 400, 17}, {0, 0, 1, 2, 3}},
          {{-9, 20, -300}, {7, 21, 400}},
          1,
          2,
          3,
          4,
          5,
          6,
          {6, 7},
          "cannot be read",
          {{"a.gltf", {1, 2, 3, 4}, true}, {"b c.bin", {}, false}},
          0.5,
          {"a warning", lost_faces()},
          2.5,
          {0, 3},
          {1, 2},
          true};
}

TEST(CellJob, ComesBackFromItsBytes) {
  const CellJob job = some_job(), back = job_from_bytes(to_bytes(job));
  EXPECT_EQ(back.id, job.id);
  EXPECT_EQ(back.name, job.name);
  EXPECT_EQ(back.lattice_min, job.lattice_min);
  EXPECT_EQ(back.cell_voxels, job.cell_voxels);
  EXPECT_EQ(back.tiles, job.tiles);
  EXPECT_EQ(back.triangles, job.triangles);
  EXPECT_EQ(back.fingerprint, job.fingerprint);
  EXPECT_EQ(back.tile_sources, job.tile_sources);
}

TEST(CellJob, IsRefusedWhereItKnowsTheSourcesOfSomeTilesOnly) {
  CellJob job = some_job();
  job.tile_sources.pop_back();
  EXPECT_THROW(job_from_bytes(to_bytes(job)), InputError);
  job.tile_sources.clear();
  EXPECT_TRUE(job_from_bytes(to_bytes(job)).tile_sources.empty());
}

TEST(CellReport, ComesBackFromItsBytes) {
  const CellReport report = some_report(), back = report_from_bytes(to_bytes(report));
  EXPECT_EQ(back.id, report.id);
  EXPECT_EQ(back.outcome, report.outcome);
  EXPECT_EQ(back.error, report.error);
  EXPECT_EQ(back.cell.file, report.cell.file);
  EXPECT_EQ(back.cell.voxels, report.cell.voxels);
  EXPECT_EQ(back.cell.content_hash, report.cell.content_hash);
  EXPECT_EQ(back.kernel_s, report.kernel_s);
  EXPECT_EQ(back.peak_bytes, report.peak_bytes);
  EXPECT_EQ(back.shard, report.shard);
  EXPECT_EQ(back.levels, report.levels);
}

// 2026-11-22: a byte that is the code of no outcome was accepted from a journal or a rank.
TEST(CellReport, IsRefusedWhereItsOutcomeIsUnknown) {
  constexpr std::size_t outcome_at = sizeof(CellReport::id);
  for (const CellOutcome outcome : values_of<CellOutcome>()) {
    CellReport report = some_report();
    report.outcome = outcome;
    EXPECT_EQ(to_bytes(report).at(outcome_at), std::uint8_t(outcome));
    EXPECT_EQ(report_from_bytes(to_bytes(report)).outcome, outcome);
  }
  std::vector<std::uint8_t> bytes = to_bytes(some_report());
  bytes.at(outcome_at) = 200;
  try {
    report_from_bytes(bytes);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("holds 200, expected the number of one of baked"), std::string::npos)
        << error.what();
  }
}

TEST(TileScan, ComesBackFromItsBytes) {
  const TileScan scan = some_scan(), back = scan_from_bytes(to_bytes(scan));
  EXPECT_EQ(back.tile, scan.tile);
  ASSERT_EQ(back.columns.size(), 2u);
  EXPECT_EQ(back.columns[0].z_min, -300);
  EXPECT_EQ(back.columns[1].triangles, 3u);
  EXPECT_EQ(back.bounds, scan.bounds);
  EXPECT_EQ(back.skipped_lines, scan.skipped_lines);
  EXPECT_EQ(back.classified, scan.classified);
  EXPECT_EQ(back.sized, scan.sized);
  EXPECT_EQ(back.is_refused, scan.is_refused);
  EXPECT_EQ(back.source, scan.source);
  EXPECT_EQ(back.error, scan.error);
  EXPECT_EQ(back.spacing_m, 0.5);
  EXPECT_EQ(back.columns[0].projected_voxels, scan.columns[0].projected_voxels);
  EXPECT_EQ(back.too_far, scan.too_far);
  EXPECT_EQ(back.reach_m, 2.5);
  EXPECT_EQ(back.warnings, scan.warnings);
  ASSERT_EQ(back.files.size(), 2u);
  EXPECT_EQ(back.files[0].name, "a.gltf");
  EXPECT_EQ(back.files[0].stamp, scan.files[0].stamp);
  EXPECT_TRUE(back.files[0].settled);
  EXPECT_FALSE(back.files[1].settled);
}

template <class Read>
void expect_only_the_whole_is_taken(std::vector<std::uint8_t> bytes, const Read& read) {
  EXPECT_NO_THROW(read(bytes));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(read(std::span(bytes).first(size)), InputError) << size;
  bytes.push_back(0);
  EXPECT_THROW(read(bytes), InputError);
}

TEST(CellJob, IsRefusedWhereBytesAreMissingOrLeftOver) {
  expect_only_the_whole_is_taken(to_bytes(some_job()), [](auto bytes) { return job_from_bytes(bytes); });
  expect_only_the_whole_is_taken(to_bytes(some_report()), [](auto bytes) { return report_from_bytes(bytes); });
  expect_only_the_whole_is_taken(to_bytes(some_scan()), [](auto bytes) { return scan_from_bytes(bytes); });
}

TEST(CellReport, OfRandomBytesIsAnErrorOrAReportButNeverACrash) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const std::vector<std::uint8_t> whole = to_bytes(some_report());
  for (int round = 0; round < 20000; ++round) {
    std::vector<std::uint8_t> bytes = whole;
    for (std::uint64_t i = 1 + rng() % 8; i-- > 0;) bytes[rng() % bytes.size()] = std::uint8_t(rng());
    try {
      EXPECT_LE(report_from_bytes(bytes).cell.voxels.size(), bytes.size());
    } catch (const InputError&) {
      continue;
    }
  }
}

}  // namespace
}  // namespace gigabake
