#include "cluster/watch/bake_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "cluster/mpi/collective.h"
#include "core/base/error.h"
#include "scheduler/journal/journal.h"
#include "tests/scheduler/made_bake.h"

namespace gigabake {
namespace {

using testing::ElementsAre;

/// A folder of a bake under way, whose files the test writes as rank 0 does.
class BakeWatchTest : public ::testing::Test {
 protected:
  BakeWatchTest() {
    for (std::uint32_t i = 0; i < plan.jobs.size(); ++i) {
      plan.jobs[i].tiles = {i};
      plan.jobs[i].triangles = 10 * (i + 1);
    }
    status.state = BakeState::baking;
    status.started_s = 1000;
    status.host = host_name();
    status.pid = ::getpid();
  }

  void begin() {
    SceneHeader header;
    header.voxel_size_m = 0.5;
    write_plan_record(folder / "plan", plan_record_of(plan.jobs, header, {"t0", "t1", "t2", "t3"}));
    report();
  }
  void report() { write_status(folder.path(), status); }
  void finish(const CellReport& report) {
    Journal journal(folder / "journal", read_journal(folder / "journal"));
    journal.append(plan.jobs[report.id], report);
  }
  CellReport bake(std::uint32_t job) { return bake_cell_of_text(plan.jobs[job], folder.path()); }

  TestFolder folder;
  BakePlan plan = made_plan(4);
  BakeStatus status;
  BakeWatch watch{folder.path(), 0};
  std::vector<std::uint32_t> changed;
};

TEST_F(BakeWatchTest, ShowsNothingBeforeTheCellsArePlanned) {
  EXPECT_EQ(watch.poll(changed), nullptr);
  status.state = BakeState::scanning;
  begin();  // the plan of an earlier bake that was killed
  EXPECT_EQ(watch.poll(changed), nullptr);
}

TEST_F(BakeWatchTest, TellsEachCellOnceWhenItsStateChanges) {
  begin();
  const WatchedScene* watched = watch.poll(changed);
  ASSERT_NE(watched, nullptr);
  EXPECT_THAT(changed, ElementsAre());
  EXPECT_THAT(watched->states, testing::Each(CellState::waiting));
  ASSERT_EQ(watched->scene.cells.size(), 4u);
  EXPECT_EQ(watched->scene.cells[1].file, "");
  EXPECT_EQ(watched->scene.cells[1].lods, 4u);

  status.workers = {{0, "here", false, 0, {"c_1_0_0", "c_2_0_0"}}};
  report();
  ASSERT_EQ(watch.poll(changed), watched);
  EXPECT_THAT(changed, ElementsAre(1, 2));
  EXPECT_EQ(watched->states[1], CellState::baking);

  finish(bake(1));
  finish(empty_cell(plan.jobs[3]));
  watch.poll(changed);
  EXPECT_THAT(changed, ElementsAre(1, 3));
  EXPECT_EQ(watched->states[1], CellState::done);
  EXPECT_EQ(watched->scene.cells[1].file, shard_file("c_1_0_0", plan.jobs[1].fingerprint));
  EXPECT_EQ(watched->states[3], CellState::done);
  EXPECT_EQ(watched->scene.cells[3].file, "");

  status.workers[0].cells = {};
  report();
  append_failed_cell(folder / "plan", {0, "out of memory"});
  watch.poll(changed);
  EXPECT_THAT(changed, ElementsAre(0, 2));
  EXPECT_EQ(watched->states[0], CellState::failed);
  EXPECT_EQ(watched->states[2], CellState::waiting);
  watch.poll(changed);
  EXPECT_THAT(changed, ElementsAre());
}

TEST_F(BakeWatchTest, ReportsTilesCostAndErrorOfACell) {
  begin();
  finish(bake(3));
  append_failed_cell(folder / "plan", {2, "out of memory"});
  watch.poll(changed);
  const CellFacts done = watch.facts(3), failed = watch.facts(2);
  EXPECT_EQ(done.name, "c_3_0_0");
  EXPECT_THAT(done.tiles, ElementsAre("t3"));
  EXPECT_DOUBLE_EQ(done.cost, 0.4);
  EXPECT_DOUBLE_EQ(done.seconds, 1.5);
  EXPECT_EQ(failed.state, CellState::failed);
  EXPECT_EQ(failed.error, "out of memory");
  EXPECT_EQ(failed.triangles, 30u);
}

TEST_F(BakeWatchTest, ARecordWithoutItsShardIsNotDone) {
  const CellReport baked = bake(1);
  const std::string shard = read_text(folder / baked.cell.file);
  finish(baked);
  write_text(folder / baked.cell.file, "damaged and of another size");
  begin();
  const WatchedScene* watched = watch.poll(changed);
  EXPECT_EQ(watched->states[1], CellState::waiting);
  write_text(folder / baked.cell.file, shard);  // this host sees it later
  status.updated_s = 1;
  report();
  watch.poll(changed);
  EXPECT_THAT(changed, ElementsAre(1));
  EXPECT_EQ(watched->states[1], CellState::done);
}

TEST_F(BakeWatchTest, RecordsOfEarlierBakesWithOtherInputsAreIgnored) {
  finish(bake(0));
  plan.jobs[0].fingerprint = {77, 77};
  begin();
  EXPECT_THAT(watch.poll(changed)->states, testing::Each(CellState::waiting));
}

SceneCell previous_cell(Vec3i64 at, const std::string& name) {
  return {name, "shards/" + name + ".h5", at, 64, 4, 1, 1, {1, 1, 1, 1}, {9, 9}, {{1, 1}, {1, 1}, {1, 1}, {1, 1}}};
}

TEST_F(BakeWatchTest, TheCellsOfThePreviousSceneStayUntilTheirPlaceIsBaked) {
  SceneDescription previous;
  previous.voxel_size_m = 0.5;
  previous.parameters = "{}";
  previous.cells = {previous_cell({0, 0, 0}, "same"), previous_cell({64, 0, 32}, "overlaps"),
                    previous_cell({512, 0, 0}, "elsewhere")};
  write_scene(folder / "scene.xml", previous);
  begin();
  const WatchedScene* watched = watch.poll(changed);
  ASSERT_EQ(watched->scene.cells.size(), 5u);
  EXPECT_EQ(watched->scene.cells[0].file, "shards/same.h5");
  EXPECT_EQ(watched->states[0], CellState::waiting);
  EXPECT_EQ(watched->scene.cells[1].file, "");
  EXPECT_EQ(watched->scene.cells[4].file, "shards/elsewhere.h5");
  EXPECT_EQ(watched->states[4], CellState::done);
  finish(empty_cell(plan.jobs[0]));
  watch.poll(changed);
  EXPECT_EQ(watched->scene.cells[0].file, "");
}

TEST_F(BakeWatchTest, APreviousSceneOfAnotherLatticeIsNotShown) {
  SceneDescription previous;
  previous.voxel_size_m = 0.25;
  previous.parameters = "{}";
  previous.cells = {previous_cell({0, 0, 0}, "same")};
  write_scene(folder / "scene.xml", previous);
  begin();
  EXPECT_EQ(watch.poll(changed)->scene.cells[0].file, "");
}

TEST_F(BakeWatchTest, TheSceneIsThePublishedOneAfterTheEnd) {
  begin();
  const std::uint64_t bake = watch.poll(changed)->bake;
  SceneDescription scene;
  scene.voxel_size_m = 0.5;
  scene.parameters = "{}";
  scene.cells = {previous_cell({0, 0, 0}, "same")};
  write_scene(folder / "scene.xml", scene);
  EXPECT_NE(watch.poll(changed), nullptr) << "the bake still publishes";
  status.state = BakeState::complete;
  report();
  EXPECT_EQ(watch.poll(changed), nullptr);
  status.state = BakeState::baking;
  status.started_s = 2000;
  begin();
  ASSERT_NE(watch.poll(changed), nullptr);
  EXPECT_NE(watch.poll(changed)->bake, bake);
}

TEST_F(BakeWatchTest, AnInterruptedBakeIsShownIfThereIsNoScene) {
  status.pid = 0;  // of no process
  begin();
  finish(bake(2));
  ASSERT_NE(watch.poll(changed), nullptr);
  EXPECT_EQ(watch.poll(changed)->states[2], CellState::done);
}

TEST_F(BakeWatchTest, AMalformedPlanIsAnError) {
  begin();
  write_text(folder / "plan", "no plan");
  EXPECT_THROW(watch.poll(changed), InputError);
}

}  // namespace
}  // namespace gigabake
