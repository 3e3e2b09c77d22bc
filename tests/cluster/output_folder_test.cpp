#include "cluster/bake/output_folder.h"

#include <csignal>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.h"
#include "tests/scheduler/made_bake.h"

namespace gigabake {
namespace {

namespace fs = std::filesystem;

class OutputFolderTest : public ::testing::Test {
 protected:
  fs::path out() const { return folder / "out"; }
  std::string line_of_a_second_bake() const {
    try {
      const OutputFolder second(out(), folder / "scene.glb");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  SceneDescription scene_of(const BakePlan& plan) const {
    SceneDescription scene;
    scene.voxel_size_m = 1;
    for (const CellJob& job : plan.jobs) scene.cells.push_back(bake_cell_of_text(job, out()).cell);
    return scene;
  }

  TestFolder folder;
};

TEST_F(OutputFolderTest, HasOneBakeAtATimeAndNamesIt) {
  EXPECT_EQ(lock_holder(out()), std::nullopt);
  {
    const OutputFolder first(out(), folder / "scene.glb");
    const std::string holder = lock_holder(out()).value();
    EXPECT_EQ(holder.find("process " + std::to_string(::getpid()) + " on "), 0u) << holder;
    EXPECT_NE(holder.find(" since 2"), std::string::npos) << holder;
    write_text(out() / "shards/.c_0_0_0.h5.1-1.part", "somebody writes");
    const std::string line = line_of_a_second_bake();
    EXPECT_EQ(line, out().string() + ": is being baked into by " + holder);
    EXPECT_TRUE(fs::exists(out() / "shards/.c_0_0_0.h5.1-1.part"));
    EXPECT_EQ(lock_holder(out()), holder);
  }
  EXPECT_EQ(lock_holder(out()), std::nullopt);
  EXPECT_EQ(line_of_a_second_bake(), "");
}

TEST_F(OutputFolderTest, IsFreeAgainWhenItsHolderWasKilled) {
  fs::create_directories(out());
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const FolderLock lock(out());
    if (::write(ready[1], "x", 1) != 1) ::_exit(1);
    ::pause();
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_EQ(lock_holder(out()).value().find("process " + std::to_string(child) + " on "), 0u);
  EXPECT_NE(line_of_a_second_bake(), "");
  ::kill(child, SIGKILL);
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  EXPECT_TRUE(fs::exists(out() / ".lock"));
  EXPECT_EQ(lock_holder(out()), std::nullopt);
  EXPECT_EQ(line_of_a_second_bake(), "");
  ::close(ready[0]), ::close(ready[1]);
}

// Regression of 2026-11-25: `journal` and `.lock` were written through links, and the linked files were truncated.
TEST_F(OutputFolderTest, WritesThroughNoLinks) {
  for (const char* name : {"journal", ".lock"})
    for (const bool is_hard : {false, true}) {
      fs::remove_all(out());
      fs::create_directories(out());
      write_text(folder / "thesis.tex", "mine");
      is_hard ? fs::create_hard_link(folder / "thesis.tex", out() / name)
              : fs::create_symlink(folder / "thesis.tex", out() / name);
      EXPECT_NE(line_of_a_second_bake().find("is a link to another file"), std::string::npos) << name;
      EXPECT_EQ(fs::file_size(folder / "thesis.tex"), 4u);
    }
}

// Regression of 2026-11-23: if a bake was killed and its command was repeated at once, the command could fail with "is
// being baked into by". A killed process keeps its files open until its pending writes are on disk.
TEST_F(OutputFolderTest, IsWaitedForWhereItsHolderWasKilledAndItsFilesAreStillOpen) {
  fs::create_directories(out());
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const FolderLock lock(out());
    if (::fork() == 0) {  // the grandchild shares the open files and the lock
      ::usleep(300000);
      ::_exit(0);
    }
    if (::write(ready[1], "x", 1) != 1) ::_exit(1);
    ::pause();
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  ::kill(child, SIGKILL);
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  EXPECT_NE(lock_holder(out()), std::nullopt);
  EXPECT_EQ(line_of_a_second_bake(), "");
  ::close(ready[0]), ::close(ready[1]);
}

TEST_F(OutputFolderTest, KeepsShardsOfEarlierBakesUntilTheyArePruned) {
  const OutputFolder folder_held(out(), folder / "scene.glb");
  scene_of(made_plan(3, 1));
  const SceneDescription scene = scene_of(made_plan(2, 2));
  write_text(out() / "shards/notes.txt", "a stranger's");
  folder_held.publish(scene);
  const OrphanShards orphans = folder_held.orphans(scene);
  EXPECT_EQ(orphans.files, 3u);
  EXPECT_EQ(orphans.bytes, 3 * std::string("shard of c_0_0_0").size());
  const OrphanShards gone = folder_held.remove_orphans(scene);
  EXPECT_EQ(gone.files, 3u);
  EXPECT_EQ(gone.bytes, orphans.bytes);
  EXPECT_EQ(folder_held.orphans(scene).files, 0u);
  for (const SceneCell& cell : scene.cells) EXPECT_TRUE(fs::exists(out() / cell.file));
  EXPECT_TRUE(fs::exists(out() / "shards/notes.txt"));
}

/// 2026-11-26: a rank that was killed while it wrote its last status left .status.json.PID-N.part for good.
TEST_F(OutputFolderTest, RemovesWhatKilledWritersLeftWhenItIsOpenedWhenItPublishesAndWhenItIsClosed) {
  const std::vector<std::string> leftovers = {"shards/.c_0_0_0-ab.h5.9-1.part",
                                              "shards/.p1_0_0_0-ab.h5.9-1.part",
                                              ".scene.xml.9-1.part",
                                              ".journal.9-1.part",
                                              ".survey.cache.9-1.part",
                                              ".status.json.9-1.part"};
  const std::vector<std::string> of_others = {".notes.part", ".notes.txt.9-1.part", ".scene.xml.part",
                                              "shards/.x.h5.9-1.part"};
  fs::create_directories(out() / "shards");
  const auto write_them = [&](const std::vector<std::string>& names) {
    for (const std::string& name : names) write_text(out() / name, "half");
  };
  const auto left = [&](const std::vector<std::string>& names) {
    return std::count_if(names.begin(), names.end(), [&](const auto& name) { return fs::exists(out() / name); });
  };
  write_them(of_others);
  write_them(leftovers);
  {
    const OutputFolder folder_held(out(), folder / "scene.glb");
    EXPECT_EQ(left(leftovers), 0);
    write_them(leftovers);
    folder_held.publish(scene_of(made_plan(1)));
    EXPECT_EQ(left(leftovers), 0);
    write_them(leftovers);
  }
  EXPECT_EQ(left(leftovers), 0) << "also of a bake that published nothing";
  EXPECT_EQ(left(of_others), std::ptrdiff_t(of_others.size()));
}

TEST_F(OutputFolderTest, RemovesWhatKilledWritersOfPagesLeft) {
  fs::create_directories(out() / "pages");
  const fs::path left = out() / "pages/.g_0_0_0_64-ab.xml.9-1.part", of_others = out() / "pages/.notes.txt.9-1.part";
  write_text(left, "half");
  write_text(of_others, "a stranger's");
  {
    const OutputFolder folder_held(out(), folder / "scene.glb");
    EXPECT_FALSE(fs::exists(left));
    write_text(left, "half");
  }
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(of_others));
}

TEST_F(OutputFolderTest, GoesWithWhatItMadeWhereNothingWasBaked) {
  { const OutputFolder made(folder / "new/out", folder / "scene.glb"); }
  EXPECT_FALSE(fs::exists(folder / "new"));
}

}  // namespace
}  // namespace gigabake
