#include "viewer/stream/pager.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mutex>
#include <random>
#include <set>
#include <thread>

#include "core/base/error.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint64_t plenty = UINT64_MAX;

PageKey page(std::uint32_t block) { return {0, 0, block}; }

std::vector<PageKey> pages(std::uint32_t first, std::uint32_t count) {
  std::vector<PageKey> keys;
  for (std::uint32_t i = 0; i < count; ++i) keys.push_back(page(first + i));
  return keys;
}

/// A source of synthetic pages that records all reads. A page has `voxels` voxels, which store the page's number.
class Shelf {
 public:
  explicit Shelf(std::size_t voxels = 100) : voxels_(voxels) {}

  PageSource source() {
    return [this](const PageKey& key) {
      std::unique_lock lock(mutex_);
      read_.push_back(key.block);
      changed_.notify_all();
      changed_.wait(lock, [&] { return open_; });
      if (broken_.contains(key.block)) throw InputError("shelf.h5", "/lod_0", "torn\nout");
      return made(key.block, voxels_);
    };
  }
  static Page made(std::uint32_t block, std::size_t voxels) {
    Page made;
    made.bricks.rgba.assign(4 * voxels, std::uint8_t(block));
    return made;
  }
  std::uint64_t page_bytes() const { return made(0, voxels_).bytes(); }

  void break_page(std::uint32_t block) { broken_.insert(block); }
  /// Closes the source: readers wait inside it until it is opened again.
  void close() { set_open(false); }
  void open() { set_open(true); }
  void wait_until_reading(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return read_.size() >= count; });
  }
  std::vector<std::uint32_t> read() const {
    const std::scoped_lock lock(mutex_);
    return read_;
  }

 private:
  void set_open(bool open) {
    const std::scoped_lock lock(mutex_);
    open_ = open;
    changed_.notify_all();
  }
  std::size_t voxels_;
  std::set<std::uint32_t> broken_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = true;
  std::vector<std::uint32_t> read_;
};

/// Runs passes until no request is left to read and all pages are resident.
void settle(Pager& pager) {
  do {
    pager.wait();
    pager.begin_pass();
  } while (pager.counts().queued > 0);
  pager.begin_pass();
}

/// Like settle(), but waits actively and runs a single pass.
void settle_at_once(Pager& pager) {
  while (pager.counts().queued > 0) std::this_thread::yield();
  pager.begin_pass();
}

std::vector<std::uint32_t> here(const Pager& pager, std::uint32_t first, std::uint32_t count) {
  std::vector<std::uint32_t> found;
  for (const PageKey& key : pages(first, count))
    if (const Page* p = pager.find(key)) found.push_back(p->bricks.rgba.empty() ? 999 : p->bricks.rgba[0]);
  return found;
}

TEST(Pager, GivesWhatWasWantedFromTheNextPassOn) {
  Shelf shelf;
  Pager pager(shelf.source(), {2, plenty});
  EXPECT_FALSE(pager.begin_pass());
  EXPECT_EQ(pager.find(page(1)), nullptr);
  pager.request({page(1)});
  pager.wait();
  EXPECT_EQ(pager.find(page(1)), nullptr) << "the page arrived during a pass";
  EXPECT_TRUE(pager.begin_pass());
  EXPECT_THAT(here(pager, 0, 3), ElementsAre(1));
  EXPECT_FALSE(pager.begin_pass());
  EXPECT_EQ(pager.counts().reads, 1u);
  EXPECT_EQ(pager.counts().bytes, shelf.page_bytes());
  EXPECT_EQ(pager.counts().queued, 0u);
}

TEST(Pager, ReadsInOrderOfUrgencyAndNothingTwice) {
  Shelf shelf;
  Pager pager(shelf.source(), {1, plenty});
  pager.request({page(5), page(2), page(5), page(9), page(2)});
  settle(pager);
  pager.request({page(9), page(5), page(1)});
  settle(pager);
  EXPECT_THAT(shelf.read(), ElementsAre(5, 2, 9, 1));
}

TEST(Pager, ReadsOnlyWhatWasWantedLastButFinishesWhatItHasBegun) {
  Shelf shelf;
  shelf.close();
  Pager pager(shelf.source(), {1, plenty});
  pager.request(pages(0, 50));
  shelf.wait_until_reading(1);
  EXPECT_EQ(pager.counts().queued, 50u);
  pager.request({page(7), page(0)});
  EXPECT_EQ(pager.counts().queued, 2u) << "the one being read, and 7";
  shelf.open();
  settle(pager);
  EXPECT_THAT(shelf.read(), ElementsAre(0, 7));
  EXPECT_THAT(here(pager, 0, 50), ElementsAre(0, 7));
  pager.request({});
  pager.wait();
  EXPECT_EQ(pager.counts().queued, 0u);
}

TEST(Pager, EvictsTheLeastRecentlyUsedFirst) {
  Shelf shelf;
  Pager pager(shelf.source(), {1, 4 * shelf.page_bytes()});
  pager.request(pages(0, 4));
  settle(pager);
  for (const std::uint32_t last : {3, 1, 0, 2}) {  // one pass each
    pager.begin_pass();
    EXPECT_NE(pager.find(page(last)), nullptr);
  }
  pager.begin_pass();
  EXPECT_NE(pager.find(page(3)), nullptr) << "now 1 is the longest unused, then 0";
  pager.request({page(10)});
  settle(pager);
  EXPECT_THAT(here(pager, 0, 11), ElementsAre(0, 2, 3, 10));
  pager.begin_pass();
  EXPECT_THAT(here(pager, 2, 2), ElementsAre(2, 3));
  pager.request(pages(20, 2));
  settle_at_once(pager);
  EXPECT_THAT(here(pager, 0, 22), ElementsAre(2, 3, 20, 21));
}

TEST(Pager, KeepsWhatThePassFindsHoweverLittleMemoryThereIs) {
  Shelf shelf;
  Pager pager(shelf.source(), {3, 1});
  for (int pass = 0; pass < 100 && here(pager, 0, 20).size() < 20; ++pass) {
    std::vector<PageKey> missing;
    for (const PageKey& key : pages(0, 20))
      if (pager.find(key) == nullptr) missing.push_back(key);
    pager.request(missing);
    pager.wait();
    pager.begin_pass();
  }
  EXPECT_EQ(here(pager, 0, 20).size(), 20u);
  EXPECT_EQ(pager.counts().reads, 20u) << "a page that each pass used was evicted";
  pager.begin_pass();
  pager.begin_pass();
  EXPECT_THAT(here(pager, 0, 20), IsEmpty());
  EXPECT_EQ(pager.counts().bytes, 0u);
}

TEST(Pager, LeavesWhatDoesNotFitForALaterCall) {
  Shelf shelf;
  Pager pager(shelf.source(), {1, 3 * shelf.page_bytes()});
  pager.request(pages(0, 10));
  settle_at_once(pager);
  EXPECT_EQ(pager.counts().reads, 3u);
  EXPECT_THAT(here(pager, 0, 10), ElementsAre(0, 1, 2));
  pager.request(pages(3, 7));
  pager.request(pages(3, 7));
  settle_at_once(pager);
  EXPECT_THAT(shelf.read(), ElementsAre(0, 1, 2, 3)) << "one beyond the bound, so that the pass can end";
  EXPECT_EQ(pager.counts().peak_bytes, 4 * shelf.page_bytes());
}

/// Each pass looks up 12 pages, half of the 24 pages that fit into the memory.
TEST(Pager, KeepsWithinItsMemoryButForThePagesBeingRead) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (const int threads : {1, 2, 5}) {
    Shelf shelf;
    const std::uint64_t memory = 24 * shelf.page_bytes() + 7;
    Pager pager(shelf.source(), {threads, memory});
    for (int pass = 0; pass < 400; ++pass) {
      std::vector<PageKey> missing;
      for (const PageKey& key : pages(std::uint32_t(rng() % 90), 12))
        if (pager.find(key) == nullptr) missing.push_back(key);
      pager.request(missing);
      if (rng() % 3 != 0) pager.wait();
      if (rng() % 3 == 0) std::this_thread::yield();
      pager.begin_pass();
      EXPECT_LE(pager.counts().bytes, memory + 12 * shelf.page_bytes());
    }
    EXPECT_LE(pager.counts().peak_bytes, memory + std::uint64_t(threads) * shelf.page_bytes());
    EXPECT_GT(pager.counts().reads, 100u);
  }
}

TEST(Pager, HoldsTheSamePagesWhateverTheNumberOfThreads) {
  for (const int threads : {1, 2, 4, 16}) {
    Shelf shelf;
    shelf.break_page(13);
    Pager pager(shelf.source(), {threads, plenty});
    pager.request(pages(0, 200));
    settle(pager);
    std::vector<std::uint32_t> found = here(pager, 0, 200);
    ASSERT_EQ(found.size(), 199u) << threads;
    for (std::uint32_t i = 0; i < 199; ++i) EXPECT_EQ(found[i], i < 13 ? i : i + 1);
    EXPECT_EQ(pager.counts().reads, 199u);
  }
}

TEST(Pager, TellsOfADamagedPageOnceAndReadsTheOthers) {
  Shelf shelf;
  shelf.break_page(1);
  shelf.break_page(2);
  Pager pager(shelf.source(), {2, plenty});
  pager.request(pages(0, 4));
  settle(pager);
  EXPECT_THAT(here(pager, 0, 4), ElementsAre(0, 3));
  EXPECT_TRUE(pager.is_damaged(page(1)) && pager.is_damaged(page(2)));
  EXPECT_FALSE(pager.is_damaged(page(0)) || pager.is_damaged(page(4)));
  EXPECT_THAT(pager.problems(), ElementsAre("shelf.h5: /lod_0: torn out")) << "the same for both";
  pager.request(pages(0, 4));
  pager.wait();
  EXPECT_EQ(shelf.read().size(), 4u) << "a page that failed is not tried again";
}

TEST(Pager, NamesThePageWhereTheErrorDoesNot) {
  Pager pager(
      [](const PageKey& key) -> Page {
        if (key.part < 0) throw std::bad_alloc();
        throw 42;
      },
      {1, plenty});
  pager.request({{3, -1, 4}, {3, 2, 5}});
  settle(pager);
  ASSERT_EQ(pager.problems().size(), 2u);
  EXPECT_THAT(pager.problems()[0], HasSubstr("shard 3, nodes, block 4: "));
  EXPECT_THAT(pager.problems()[1], HasSubstr("shard 3, level 2, block 5: "));
  EXPECT_TRUE(pager.is_damaged({3, -1, 4}) && pager.is_damaged({3, 2, 5}));
}

TEST(Pager, CountsDamageAsAnArrival) {
  Shelf shelf;
  shelf.break_page(0);
  Pager pager(shelf.source(), {1, plenty});
  pager.request({page(0)});
  pager.wait();
  EXPECT_FALSE(pager.is_damaged(page(0)));
  EXPECT_TRUE(pager.begin_pass());
  EXPECT_TRUE(pager.is_damaged(page(0)));
}

TEST(Pager, GoesWhileItReads) {
  Shelf shelf;
  shelf.close();
  std::jthread opener;
  {
    Pager pager(shelf.source(), {2, plenty});
    pager.request(pages(0, 1000));
    shelf.wait_until_reading(2);
    opener = std::jthread([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      shelf.open();
    });
  }
  EXPECT_LT(shelf.read().size(), 1000u) << "it waited for reads that were not needed any more";
}

/// Several threads look up pages while the pager has too little memory: found pages stay valid until the pass ends.
TEST(Pager, IsFoundInByManyThreadsWhileItReadsAndLetsGo) {
  Shelf shelf;
  Pager pager(shelf.source(), {2, 30 * shelf.page_bytes()});
  for (int pass = 0; pass < 200; ++pass) {
    std::vector<std::jthread> finders;
    std::atomic<int> wrong = 0;
    std::mutex mutex;
    std::vector<PageKey> missing;
    for (int t = 0; t < 3; ++t)
      finders.emplace_back([&, t] {
        std::mt19937_64 rng(std::uint64_t(pass / 10 * 3 + t));
        for (int i = 0; i < 12; ++i) {
          const PageKey key = page(std::uint32_t(rng() % 100));
          const Page* found = pager.find(key);
          if (found == nullptr) {
            const std::scoped_lock lock(mutex);
            missing.push_back(key);
          } else if (found->bricks.rgba != Shelf::made(key.block, 100).bricks.rgba || found != pager.find(key)) {
            ++wrong;
          }
        }
      });
    if (pass % 2 == 0) pager.request(pages(std::uint32_t(pass) % 100, 10));
    finders.clear();
    EXPECT_EQ(wrong, 0) << "pass " << pass;
    pager.request(missing);
    pager.begin_pass();
  }
}

}  // namespace
}  // namespace gigabake
