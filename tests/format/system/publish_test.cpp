#include "format/system/publish.h"

#include <fstream>
#include <gtest/gtest.h>
#include <memory>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.h"
#include "format/system/publish_folder.h"
#include "small_disk.h"
#include "tests/format/shard/made_shard.h"

namespace gigabake {
namespace {

using made::TempFolder;

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::size_t files_in(const TempFolder& folder) {
  return std::size_t(std::distance(std::filesystem::directory_iterator(folder.path()), {}));
}

TEST(Publish, ReplacesAFileAndLeavesNothingElse) {
  const TempFolder folder;
  publish_file(folder / "scene.xml", "first");
  publish_file(folder / "scene.xml", "second");
  EXPECT_EQ(content(folder / "scene.xml"), "second");
  EXPECT_EQ(files_in(folder), 1u);
}

TEST(Publish, ReplacesAFileThatNeedNotOutliveALossOfPower) {
  const TempFolder folder;
  publish_file(folder / "status.json", "first", Durability::while_up);
  publish_file(folder / "status.json", "second", Durability::while_up);
  EXPECT_EQ(content(folder / "status.json"), "second");
  EXPECT_EQ(files_in(folder), 1u);
}

TEST(Publish, GivesTheRightsThatTheUsersMaskAllows) {
  const TempFolder folder;
  const mode_t mask = ::umask(027);
  publish_file(folder / "f", "x");
  ::umask(mask);
  struct stat info {};
  ASSERT_EQ(::stat((folder / "f").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, mode_t(0640));
}

TEST(Publish, KeepsTheOldFileWhereTheNewOneWasNeverPublished) {
  const TempFolder folder;
  publish_file(folder / "f", "old");
  {
    Publication unfinished(folder / "f");
    std::ofstream(unfinished.temporary()) << "half of the ne";
    EXPECT_EQ(content(folder / "f"), "old");
  }
  EXPECT_EQ(content(folder / "f"), "old");
  EXPECT_EQ(files_in(folder), 1u);
}

TEST(Publish, PassesOverWhatAKilledProcessLeft) {
  const TempFolder folder;
  const Publication first(folder / "f");
  const Publication second(folder / "f");
  EXPECT_NE(first.temporary(), second.temporary());
}

/// Starts a publication in a child process, which dies without calling destructors.
template <class Start>
void start_and_die(const Start& start) {
  const pid_t child = ::fork();
  if (child == 0) {
    const auto unfinished = start();
    ::_exit(unfinished->temporary().empty() ? 1 : 0);
  }
  int status = 1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_EQ(status, 0);
}

/// 2026-11-26: each killed export left its temporary folder for good.
TEST(Publish, RemovesTemporariesOfKilledProcessesButNotThoseOfLivingOnes) {
  const TempFolder folder;
  const auto target = folder / "f";
  const Publication living(target, Leftovers::remove);
  std::ofstream(folder / ".f.notes.part") << "of the user";
  std::ofstream(folder / ".fx.1-1.part") << "of another target";
  start_and_die([&] { return std::make_unique<Publication>(target, Leftovers::remove); });
  EXPECT_EQ(files_in(folder), 4u);
  {
    const Publication next(target, Leftovers::remove);
    EXPECT_EQ(files_in(folder), 4u) << "that of the killed process was replaced";
    EXPECT_TRUE(std::filesystem::exists(living.temporary()));
  }
  EXPECT_EQ(files_in(folder), 3u);
}

TEST(Publish, RemovesTemporaryFoldersOfKilledProcessesButNotThoseOfLivingOnes) {
  const TempFolder folder;
  const FolderPublication living(folder / "f");
  std::ofstream(living.temporary() / "tile") << "half";
  start_and_die([&] {
    auto killed = std::make_unique<FolderPublication>(folder / "f");
    std::filesystem::create_directory(killed->temporary() / "tiles");
    return killed;
  });
  FolderPublication next(folder / "f");
  EXPECT_EQ(files_in(folder), 2u);
  next.publish();
  EXPECT_TRUE(std::filesystem::exists(living.temporary() / "tile"));
  EXPECT_EQ(files_in(folder), 2u) << "the published folder and that of the living process";
}

TEST(Publish, NamesTheTargetWhereItsFolderIsMissing) {
  const TempFolder folder;
  try {
    publish_file(folder / "absent" / "f", "x");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("absent/f: cannot write: No such file"), std::string::npos);
  }
}

TEST(Publish, LeavesAFolderAloneThatStandsInTheWay) {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "f");
  EXPECT_THROW(publish_file(folder / "f", "x"), InputError);
  EXPECT_TRUE(std::filesystem::is_directory(folder / "f"));
  EXPECT_EQ(files_in(folder), 1u);
}

TEST(Publish, KeepsTheOldFileWhenTheDiskIsFull) {
  const TempFolder folder;
  publish_file(folder / "f", "old");
  {
    const SmallDisk disk(4096);
    EXPECT_THROW(publish_file(folder / "f", std::string(10000, 'x')), InputError);
  }
  EXPECT_EQ(content(folder / "f"), "old");
  EXPECT_EQ(files_in(folder), 1u);
}

TEST(Publish, LeavesNoShardBehindWhenTheDiskIsFull) {
  std::mt19937_64 rng(3);
  const TempFolder folder;
  const Shard shard = made::random_shard(rng, {4, true, 6});
  const std::uint64_t size = write_shard(folder / "whole.h5", shard, {}).file;
  for (const std::uint64_t room : {std::uint64_t(0), std::uint64_t(100), size / 10, size / 2, size - 1}) {
    const SmallDisk disk(room);
    try {
      write_shard(folder / "s.h5", shard, {ThreadPool(2)});
      FAIL() << room;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("/s.h5: "), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("File too large"), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(files_in(folder), 1u);
  EXPECT_EQ(made::difference(shard, read_shard(folder / "whole.h5")), "");
}

TEST(Publish, NamesTheTargetWhereTheFolderIsReadOnly) {
  if (::geteuid() == 0) GTEST_SKIP() << "the superuser may write anywhere";
  const TempFolder folder;
  ::chmod(folder.path().c_str(), 0555);
  EXPECT_THROW(publish_file(folder / "f", "x"), InputError);
  ::chmod(folder.path().c_str(), 0755);
}

}  // namespace
}  // namespace gigabake
