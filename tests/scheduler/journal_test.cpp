#include "scheduler/journal/journal.h"

#include <gtest/gtest.h>
#include <thread>

#include "core/base/error.h"
#include "made_bake.h"
#include "tests/format/system/small_disk.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

class JournalTest : public ::testing::Test {
 protected:
  std::filesystem::path path() const { return folder / "journal"; }
  /// Appends the plan's cells as baked.
  void write(const BakePlan& cells) {
    Journal journal(path(), read_journal(path()));
    for (const CellJob& job : cells.jobs) journal.append(job, bake_cell_of_text(job, folder.path()));
  }
  std::size_t known(const BakePlan& cells) const {
    const JournalContent content = read_journal(path());
    std::size_t number = 0;
    for (const CellJob& job : cells.jobs) {
      const auto report = content.find(job.fingerprint);
      if (!report) continue;
      EXPECT_EQ(report->cell.name, job.name);
      ++number;
    }
    return number;
  }

  TestFolder folder;
  BakePlan plan = made_plan(5);
};

std::vector<std::uint8_t> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

TEST_F(JournalTest, RemembersWhatWasBakedAndWhatIsEmptyButNotWhatFailed) {
  {
    Journal journal(path(), {});
    journal.append(plan.jobs[0], bake_cell_of_text(plan.jobs[0], folder.path()));
    journal.append(plan.jobs[1], empty_cell(plan.jobs[1]));
    CellReport failed;
    failed.error = "disk full";
    journal.append(plan.jobs[2], failed);
  }
  const JournalContent content = read_journal(path());
  EXPECT_EQ(content.records(), 2u);
  const auto baked = content.find(plan.jobs[0].fingerprint);
  ASSERT_TRUE(baked);
  EXPECT_EQ(baked->shard, stamp_of(folder.path() / shard_path(plan.jobs[0])));
  EXPECT_EQ(baked->cell.voxels, (std::vector<std::uint64_t>{1, 2}));
  ASSERT_TRUE(content.find(plan.jobs[1].fingerprint));
  EXPECT_EQ(content.find(plan.jobs[1].fingerprint)->outcome, CellOutcome::empty);
  EXPECT_FALSE(content.find(plan.jobs[2].fingerprint));
  EXPECT_TRUE(content.knows_cell(plan.jobs[1].name));
  EXPECT_FALSE(content.knows_cell(plan.jobs[2].name));
}

TEST_F(JournalTest, IsNoFileBeforeSomethingIsDone) {
  { Journal journal(path(), read_journal(path())); }
  EXPECT_FALSE(std::filesystem::exists(path()));
}

TEST_F(JournalTest, CutAtAnyByteKeepsTheWholeRecordsBeforeAndGoesOnBehindThem) {
  write(plan);
  const std::string whole = read_text(path());
  const BakePlan more = made_plan(2, 9);
  std::size_t last = 0;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    write_text(path(), whole.substr(0, size));
    const std::size_t kept = known(plan);
    EXPECT_LE(last, kept) << size;
    last = kept;
    if (size % 8 != 0) continue;  // each append is flushed to disk
    write(more);
    EXPECT_EQ(known(plan), kept) << size;
    EXPECT_EQ(known(more), 2u) << size;
  }
  EXPECT_EQ(last, 5u);
}

TEST_F(JournalTest, WithFlippedBytesHasNoRecordThatWasNotWritten) {
  write(plan);
  const std::string whole = read_text(path());
  const test::RandomSeed seed;
  std::mt19937_64 random(seed);
  for (int round = 0; round < 5000; ++round) {
    std::string damaged = whole;
    for (std::uint64_t i = 1 + random() % 4; i-- > 0;) damaged[random() % damaged.size()] ^= char(1 + random() % 255);
    const JournalContent content(bytes_of(damaged));
    EXPECT_LE(content.records(), 5u);
    std::size_t found = 0;
    for (const CellJob& job : plan.jobs) {
      const auto report = content.find(job.fingerprint);
      found += report.has_value();
      ASSERT_TRUE(!report || report->cell.name == job.name);
    }
    ASSERT_EQ(found, content.records());
  }
}

TEST_F(JournalTest, OfAnotherFormatIsStartedAnew) {
  write_text(path(), "gigabake journal 99\nwhatever");
  EXPECT_EQ(read_journal(path()).records(), 0u);
  write(plan);
  EXPECT_EQ(known(plan), 5u);
}

TEST_F(JournalTest, WithARecordInAnotherLayoutDoesNotKnowThatCell) {
  write(plan);
  JournalEntry entry{{77, 77}, "c_9_9_9", {}};
  std::vector<std::uint8_t> record = journal_record(entry);
  std::string file = read_text(path());
  file.append(record.begin(), record.end());
  const JournalContent content(bytes_of(file));
  EXPECT_EQ(content.records(), 6u);
  EXPECT_TRUE(content.find({77, 77}));
  EXPECT_FALSE(content.find({78, 77}));
}

TEST_F(JournalTest, IsRewrittenWhereMoreThanHalfOfItHasBeenReplaced) {
  write(plan);
  write(plan);
  EXPECT_EQ(read_journal(path()).records(), 10u);
  write(plan);  // 10 records of 5 cells are not too many
  EXPECT_EQ(read_journal(path()).records(), 15u);
  { Journal journal(path(), read_journal(path())); }
  EXPECT_EQ(read_journal(path()).records(), 5u);
  EXPECT_EQ(known(plan), 5u);
  write(made_plan(1, 3));
  EXPECT_EQ(read_journal(path()).records(), 6u);
}

TEST_F(JournalTest, KeepsTheLastRecordOfACell) {
  write(plan);
  std::filesystem::remove(folder.path() / shard_path(plan.jobs[0]));
  write(plan);
  EXPECT_EQ(read_journal(path()).find(plan.jobs[0].fingerprint)->shard,
            stamp_of(folder.path() / shard_path(plan.jobs[0])));
}

TEST_F(JournalTest, DropsCellsThatWerePrunedAndGoesOn) {
  const BakePlan old = made_plan(4, 2);
  write(old);
  Journal journal(path(), read_journal(path()));
  for (const CellJob& job : plan.jobs) journal.append(job, bake_cell_of_text(job, folder.path()));
  journal.keep_only(plan.jobs);
  EXPECT_EQ(read_journal(path()).records(), 5u);
  EXPECT_EQ(known(old), 0u);
  journal.append(old.jobs[0], bake_cell_of_text(old.jobs[0], folder.path()));
  EXPECT_EQ(known(plan), 5u);
  EXPECT_EQ(known(old), 1u);
}

TEST_F(JournalTest, FlushesToDiskWithEvery64thRecordAndAfterAFifthOfASecond) {
  Journal journal(path(), {});
  const CellReport report = empty_cell(plan.jobs[0]);
  for (int i = 0; i < 1000; ++i) {
    journal.append(plan.jobs[0], report);
    ASSERT_LT(journal.unsynced(), 64u);
  }
  journal.append(plan.jobs[0], report);
  std::this_thread::sleep_for(std::chrono::milliseconds(210));
  journal.append(plan.jobs[0], report);
  EXPECT_EQ(journal.unsynced(), 0u);
  journal.append(plan.jobs[0], report);
  journal.sync();
  EXPECT_EQ(journal.unsynced(), 0u);
}

TEST_F(JournalTest, SaysOnceThatTheDiskIsFullAndEndsWithAWholeRecord) {
  write(made_plan(3));
  const std::uint64_t size = std::filesystem::file_size(path());
  Journal journal(path(), read_journal(path()));
  const CellReport report = bake_cell_of_text(plan.jobs[4], folder.path());
  {
    const SmallDisk disk(size + 20);
    try {
      journal.append(plan.jobs[4], report);
      FAIL();
    } catch (const InputError& error) {
      const std::string line = error.what();
      EXPECT_NE(line.find("journal: cannot write: File too large"), std::string::npos) << line;
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    }
  }
  EXPECT_NO_THROW(journal.append(plan.jobs[4], report));
  EXPECT_NO_THROW(journal.sync());
  EXPECT_EQ(std::filesystem::file_size(path()), size);
  EXPECT_EQ(known(plan), 3u);
}

TEST_F(JournalTest, CanBeReadWhileItIsWritten) {
  Journal journal(path(), {});
  for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
    journal.append(plan.jobs[i], bake_cell_of_text(plan.jobs[i], folder.path()));
    EXPECT_EQ(known(plan), i + 1);
  }
}

}  // namespace
}  // namespace gigabake
