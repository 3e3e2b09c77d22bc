#include "viewer/stream/requests/pooled_pages.h"

#include <gtest/gtest.h>
#include <random>

namespace gigabake {
namespace {

kernels::PagePoolSize pool_of(std::uint32_t voxels) {
  kernels::PagePoolSize size;
  size.voxels = voxels;
  return size;
}

Page page_of(std::uint32_t voxels) {
  Page page;
  page.bricks.rgba.resize(std::size_t(4) * voxels);
  return page;
}

/// A brick that needs `pages`, and its places.
struct PlacedBrick {
  BrickPages pages{};
  kernels::CastBrick brick;
};

/// A model of the pool: the page that each voxel was last copied from.
class PoolModel {
 public:
  explicit PoolModel(std::uint32_t voxels) : owner_(voxels) {}

  void put(const std::vector<kernels::PageUpload>& pages) {
    for (const kernels::PageUpload& page : pages) {
      ASSERT_EQ(page.place.first % kernels::page_alignment, 0u);
      ASSERT_LE(page.place.first + page.count, owner_.size());
      for (std::uint32_t i = 0; i < page.count; ++i) owner_[page.place.first + i] = page.voxels.rgba;
    }
  }

  bool has(const Page& page, const kernels::PooledPage& place) const {
    for (std::size_t i = 0; i < page.bricks.rgba.size() / 4; ++i)
      if (owner_[place.first + i] != page.bricks.rgba.data()) return false;
    return true;
  }

 private:
  std::vector<const std::uint8_t*> owner_;
};

/// Whatever bricks need, their pages are in the pool when the bricks are copied.
TEST(PooledPages, StayUntilTheBricksThatNeedThemAreCopied) {
  constexpr std::uint32_t voxels = 16384;
  constexpr unsigned seed = 3;
  std::mt19937_64 random(seed);
  std::vector<Page> pages;
  for (int i = 0; i < 120; ++i) pages.push_back(page_of(1 + std::uint32_t(random() % 600)));
  PooledPages pooled(pool_of(voxels));
  PoolModel model(voxels);
  std::size_t placed = 0, refused = 0, uploads = 0;
  for (int round = 0; round < 3000; ++round) {
    std::vector<PlacedBrick> bricks;
    const std::size_t first = random() % pages.size(), count = 1 + random() % 12;
    for (std::size_t i = 0; i < count; ++i) {
      PlacedBrick next;
      for (std::size_t k = 0; k < 1 + random() % 3; ++k) next.pages[k] = &pages[(first + random() % 8) % pages.size()];
      pooled.count_use(next.pages);
      if (pooled.place(next.pages, next.brick))
        bricks.push_back(next);
      else
        ++refused;
    }
    const std::vector<kernels::PageUpload> added = pooled.take_new_pages();
    uploads += added.size();
    model.put(added);
    for (const PlacedBrick& brick : bricks)
      for (std::size_t k = 0; k < brick.pages.size() && brick.pages[k] != nullptr; ++k)
        ASSERT_TRUE(model.has(*brick.pages[k], brick.brick.pages[k])) << round;
    placed += bricks.size();
    pooled.release();
  }
  EXPECT_GT(placed, 10 * refused) << "few bricks need more pages than the pool has";
  EXPECT_GT(uploads, std::size_t(voxels) / 300) << "the ring went round";
  EXPECT_EQ(pooled.bytes_used(), std::uint64_t(4) * voxels);
}

/// A large page is uploaded only for many bricks.
TEST(PooledPages, UploadLargePagesOnceEnoughBricksNeedThem) {
  PooledPages pooled(pool_of(1 << 20));
  const Page small = page_of(1000), large = page_of(100000);
  kernels::CastBrick brick;
  pooled.count_use({&small, &large});
  EXPECT_TRUE(pooled.place({&small}, brick));
  EXPECT_FALSE(pooled.place({&small, &large}, brick));
  int uses = 1;
  while (!pooled.place({&large}, brick)) {
    pooled.count_use({&large});
    ASSERT_LT(++uses, 100);
  }
  EXPECT_EQ(uses, 13) << "400,000 bytes, 32 KiB per brick";
  EXPECT_EQ(pooled.take_new_pages().size(), 2u);
}

TEST(PooledPages, RefuseAPageWithoutTheColumnsOfThePool) {
  kernels::PagePoolSize size = pool_of(1 << 16);
  size.has_normals = true;
  PooledPages pooled(size);
  Page page = page_of(64);
  kernels::CastBrick brick;
  pooled.count_use({&page});
  EXPECT_FALSE(pooled.place({&page}, brick)) << "no normals";
  page.bricks.normal.resize(128);
  EXPECT_TRUE(pooled.place({&page}, brick));
  Page with_coverage = page;
  with_coverage.pool_mark = {};
  with_coverage.bricks.directional_coverage.resize(4 * 64);
  pooled.count_use({&with_coverage});
  EXPECT_FALSE(pooled.place({&with_coverage}, brick)) << "the pool has no coverages";
}

}  // namespace
}  // namespace gigabake
