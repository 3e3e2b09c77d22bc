#include "scheduler/journal/plan_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "format/system/read_file.h"
#include "made_bake.h"
#include "scheduler/journal/journal.h"
#include "scheduler/journal/journal_tail.h"

namespace gigabake {
namespace {

PlanRecord made_record() {
  BakePlan plan = made_plan(3);
  plan.jobs[0].tiles = {0, 2};
  plan.jobs[2].triangles = 12;
  CellJob overview;
  overview.name = "p1_0_0_0";
  overview.first_lod = 4;
  plan.jobs.push_back(overview);
  SceneHeader header;
  header.voxel_size_m = 0.25;
  header.lattice_origin_m = {1, 2, 3};
  header.origin = Geodetic{48, 11, 500};
  header.has_normals = false;
  header.parameters = "{}";
  header.bounds = {{0, 0, 0}, {190, 60, 50}};
  return plan_record_of(plan.jobs, header, {"a.glb", "b.glb", "c.glb"});
}

TEST(PlanRecord, ReadsWhatWasWrittenWithoutOverviews) {
  const TestFolder folder;
  write_plan_record(folder / "plan", made_record());
  const PlanRecord read = read_plan_record(folder / "plan").record;
  EXPECT_EQ(read.header.voxel_size_m, 0.25);
  EXPECT_EQ(read.header.origin, (Geodetic{48, 11, 500}));
  EXPECT_FALSE(read.header.has_normals);
  EXPECT_EQ(read.header.bounds, made_record().header.bounds);
  EXPECT_THAT(read.tile_names, testing::ElementsAre("a.glb", "b.glb", "c.glb"));
  EXPECT_THAT(read.tiles, testing::ElementsAre(testing::ElementsAre(0, 2), testing::IsEmpty(), testing::IsEmpty()));
  ASSERT_EQ(read.cells.size(), 3u);
  EXPECT_EQ(read.cells[1].name, "c_1_0_0");
  EXPECT_EQ(read.cells[1].lattice_min, (Vec3i64{64, 0, 0}));
  EXPECT_EQ(read.cells[1].file, shard_file("c_1_0_0", {2, 1}));
  EXPECT_EQ(read.cells[2].triangles, 12u);
}

TEST(PlanRecord, FailuresAreReadOnceAndOnlyIfComplete) {
  const TestFolder folder;
  const auto path = folder / "plan";
  append_failed_cell(path, {0, "there is no file"});
  EXPECT_FALSE(std::filesystem::exists(path));
  write_plan_record(path, made_record());
  std::uint64_t at = read_plan_record(path).end;
  EXPECT_TRUE(read_failed_cells(path, at).empty());
  append_failed_cell(path, {2, "out of memory"});
  const std::string whole = read_text(path);
  append_failed_cell(path, {1, "disk full"});
  const std::string two = read_text(path);
  for (std::size_t size = whole.size(); size < two.size(); ++size) {
    write_text(path, two.substr(0, size));
    std::uint64_t from = at;
    const auto failed = read_failed_cells(path, from);
    ASSERT_EQ(failed.size(), 1u) << size;
    EXPECT_EQ(failed[0].cell, 2u);
    EXPECT_EQ(failed[0].error, "out of memory");
    EXPECT_EQ(from, whole.size());
  }
  write_text(path, two);
  at = whole.size();
  EXPECT_EQ(read_failed_cells(path, at).size(), 1u);
  EXPECT_TRUE(read_failed_cells(path, at).empty());
}

TEST(PlanRecord, EveryTruncatedFileIsRefused) {
  const TestFolder folder;
  write_plan_record(folder / "plan", made_record());
  const std::string whole = read_text(folder / "plan");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    write_text(folder / "part", whole.substr(0, size));
    EXPECT_THROW(read_plan_record(folder / "part"), InputError) << size;
  }
}

class JournalTailTest : public ::testing::Test {
 protected:
  std::vector<std::uint64_t> read(JournalTail& tail) const {
    std::vector<std::uint64_t> found;
    tail.read_new([&](const Hash128& fingerprint, const CellReport&) { found.push_back(fingerprint.lo); });
    return found;
  }
  void append(std::uint32_t job) {
    Journal journal(folder / "journal", read_journal(folder / "journal"));
    journal.append(plan.jobs[job], bake_cell_of_text(plan.jobs[job], folder.path()));
  }

  TestFolder folder;
  BakePlan plan = made_plan(5);
};

TEST_F(JournalTailTest, VisitsEachRecordOnce) {
  JournalTail tail(folder / "journal");
  EXPECT_THAT(read(tail), testing::IsEmpty());
  append(2);
  append(0);
  EXPECT_THAT(read(tail), testing::ElementsAre(3, 1));
  EXPECT_THAT(read(tail), testing::IsEmpty());
  append(4);
  EXPECT_THAT(read(tail), testing::ElementsAre(5));
}

TEST_F(JournalTailTest, WaitsForTheEndOfARecord) {
  append(0);
  const std::size_t one = read_text(folder / "journal").size();
  append(1);
  const std::string two = read_text(folder / "journal");
  for (std::size_t size = one; size < two.size(); ++size) {
    write_text(folder / "journal", two.substr(0, size));
    JournalTail tail(folder / "journal");
    EXPECT_THAT(read(tail), testing::ElementsAre(1)) << size;
    std::ofstream(folder / "journal", std::ios::binary | std::ios::app) << two.substr(size);
    EXPECT_THAT(read(tail), testing::ElementsAre(2)) << size;
  }
}

TEST_F(JournalTailTest, VisitsAllRecordsOfARewrittenJournal) {
  JournalTail tail(folder / "journal");
  append(0);
  append(1);
  EXPECT_THAT(read(tail), testing::ElementsAre(1, 2));
  Journal journal(folder / "journal", read_journal(folder / "journal"));
  journal.keep_only({plan.jobs[1]});
  EXPECT_THAT(read(tail), testing::ElementsAre(2));
}

TEST(ReadTail, ReturnsTheBytesFromAPosition) {
  const TestFolder folder;
  EXPECT_EQ(read_tail(folder / "none", 0).inode, 0u);
  write_text(folder / "text", "abcdef");
  EXPECT_THAT(read_tail(folder / "text", 4).bytes, testing::ElementsAre('e', 'f'));
  EXPECT_EQ(read_tail(folder / "text", 4).size, 6u);
  EXPECT_TRUE(read_tail(folder / "text", 7).bytes.empty());
  EXPECT_THROW(read_tail(folder.path(), 0), InputError);
}

}  // namespace
}  // namespace gigabake
