#include "viewer/stream/requests/waiting_requests.h"

#include <chrono>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"

namespace gigabake {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

PageKey block_page(std::uint32_t block) { return {0, 0, block}; }

/// Block 9 is damaged; all other pages are empty.
Page empty_page(const PageKey& key) {
  if (key.block == 9) throw InputError("shard.h5", "", "damaged");
  return {};
}

/// A pager with one reader, and the requests that wait for its pages.
struct Pass {
  Pager pager{empty_page, {1, 1 << 20}};
  WaitingRequests requests;

  void load(const std::vector<PageKey>& pages) {
    pager.request(pages);
    ASSERT_TRUE(pager.settle(std::chrono::seconds(30)));
    begin();
  }
  void begin() {
    pager.begin_pass();
    requests.begin_pass(pager);
  }
};

TEST(WaitingRequests, WaitUntilAllTheirPagesAreResident) {
  Pass pass;
  pass.requests.add(7, 1, {block_page(2), block_page(1), block_page(2)});
  pass.load({block_page(1)});
  EXPECT_TRUE(pass.requests.waits(7, 1));
  EXPECT_FALSE(pass.requests.waits(8, 1));
  pass.load({block_page(2)});
  EXPECT_FALSE(pass.requests.waits(7, 1));
}

TEST(WaitingRequests, DoNotWaitForDamagedPages) {
  Pass pass;
  pass.requests.add(7, 1, {block_page(9)});
  pass.begin();
  EXPECT_TRUE(pass.requests.waits(7, 1));
  pass.load({block_page(9)});
  EXPECT_FALSE(pass.requests.waits(7, 1));
}

TEST(WaitingRequests, WaitAgainForOtherPages) {
  Pass pass;
  pass.requests.add(7, 1, {block_page(1)});
  pass.load({block_page(1)});
  EXPECT_FALSE(pass.requests.waits(7, 1));
  pass.requests.add(7, 1, {block_page(2)});
  pass.begin();
  EXPECT_TRUE(pass.requests.waits(7, 1));
  pass.load({block_page(2)});
  EXPECT_FALSE(pass.requests.waits(7, 1));
}

TEST(WaitingRequests, WaitForThePagesThatTheyLackedLast) {
  Pass pass;
  pass.requests.add(7, 1, {block_page(1)});
  pass.requests.add(8, 1, {block_page(1)});
  pass.requests.add(7, 1, {block_page(2)});
  pass.load({block_page(1)});
  EXPECT_FALSE(pass.requests.waits(8, 1));
  EXPECT_TRUE(pass.requests.waits(7, 1));
  pass.requests.add(9, 1, {block_page(3)});  // uses the entry of the first group again
  EXPECT_TRUE(pass.requests.waits(9, 1));
  EXPECT_FALSE(pass.requests.waits(8, 1));
  pass.load({block_page(2)});
  EXPECT_FALSE(pass.requests.waits(7, 1));
  EXPECT_TRUE(pass.requests.waits(9, 1));
}

TEST(WaitingRequests, NameThePagesOfThisPassByTheirMinRank) {
  Pass pass;
  pass.requests.add(1, 30, {block_page(3)});
  pass.requests.add(2, 20, {block_page(2), block_page(1)});
  pass.requests.add(3, 10, {block_page(3)});
  EXPECT_THAT(pass.requests.pages_by_urgency(), ElementsAre(block_page(3), block_page(1), block_page(2)));
  pass.begin();
  EXPECT_THAT(pass.requests.pages_by_urgency(), IsEmpty());
  EXPECT_TRUE(pass.requests.waits(1, 40));
  EXPECT_TRUE(pass.requests.waits(2, 35));
  EXPECT_THAT(pass.requests.pages_by_urgency(), ElementsAre(block_page(1), block_page(2), block_page(3)));
  pass.requests.clear();
  EXPECT_FALSE(pass.requests.waits(1, 40));
  EXPECT_THAT(pass.requests.pages_by_urgency(), IsEmpty());
}

}  // namespace
}  // namespace gigabake
