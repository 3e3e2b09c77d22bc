#include "worker/tiles/texture_store.h"

#include <fstream>
#include <gtest/gtest.h>
#include <stdexcept>
#include <thread>
#include <vector>

#include "../glb_scene.h"
#include "core/base/error.h"
#include "core/base/thread_pool.h"
#include "tests/format/system/small_disk.h"
#include "worker/tiles/scratch_publication.h"

namespace gigabake {
namespace {

namespace fs = std::filesystem;

EncodedImage never() { throw std::logic_error("decoded again"); }

class TextureStoreTest : public testing::Test {
 protected:
  static EncodedImage image(int n) { return {"image", checkered_png(n)}; }
  static TextureKey key(int n) {
    return {{std::uint64_t(n), 7}, {n % 2 == 0 ? kernels::TextureAlpha::blend : kernels::TextureAlpha::mask, 128}};
  }
  std::shared_ptr<const CellTexture> load(int n) {
    return store.load(key(n), 1 << 20, [&] { return image(n); });
  }
  fs::path file(int n) const {
    for (const auto& entry : fs::directory_iterator(scratch))
      if (entry.path().extension() == ".texture" &&
          entry.path().filename().string().starts_with("x_" + key(n).image.hex()))
        return entry.path();
    return {};
  }

  ScratchFolder folder;
  const fs::path scratch = folder.path() / "scratch";
  TextureStore store{scratch, 1000};
};

void expect_equal(const kernels::TextureView& a, const kernels::TextureView& b) {
  ASSERT_EQ(a.width, b.width);
  ASSERT_EQ(a.height, b.height);
  ASSERT_EQ(a.levels, b.levels);
  EXPECT_EQ(a.mask_cutoff, b.mask_cutoff);
  EXPECT_TRUE(std::equal(a.base, a.base + 4 * std::size_t(a.width) * std::size_t(a.height), b.base));
  for (int l = 1; l < a.levels; ++l) {
    const std::size_t texels =
        std::size_t(kernels::level_extent(a.width, l)) * std::size_t(kernels::level_extent(a.height, l));
    EXPECT_TRUE(std::equal(a.level[l], a.level[l] + 4 * texels, b.level[l])) << l;
  }
}

TEST_F(TextureStoreTest, TexelsFromScratchAreThoseInMemory) {
  TextureStore in_memory({}, 0);
  for (const int n : {1, 2, 3, 37, 64, 200}) {
    const auto held = in_memory.load(key(n), 1 << 20, [&] { return image(n); });
    expect_equal(load(n)->view(), held->view());
    EXPECT_FALSE(file(n).empty());
  }
}

TEST_F(TextureStoreTest, AnImageIsDecodedOnceAndItsTextureKeepsItsId) {
  const std::uint64_t id = load(64)->view().id;
  EXPECT_EQ(store.load(key(64), 1 << 20, never)->view().id, id);
  TextureStore other_rank(scratch, 1000);
  expect_equal(other_rank.load(key(64), 1 << 20, never)->view(), load(64)->view());
  EXPECT_NE(load(32)->view().id, id);
}

TEST_F(TextureStoreTest, ASmallTextureStaysInMemory) {
  store.load(key(8), 1000, [] { return image(8); });
  EXPECT_FALSE(fs::exists(scratch));
}

TEST_F(TextureStoreTest, AFileThatIsCutOrChangedIsMadeAnew) {
  const auto right = load(64);
  const std::uint64_t whole = fs::file_size(file(64));
  const auto expect_made_anew = [&] {
    TextureStore other_rank(scratch, 1000);
    expect_equal(other_rank.load(key(64), 1 << 20, [] { return image(64); })->view(), right->view());
    EXPECT_EQ(fs::file_size(file(64)), whole);
  };
  for (const std::uint64_t size : {std::uint64_t(0), std::uint64_t(55), whole / 2, whole - 1}) {
    fs::copy_file(file(64), file(64).string() + ".copy");  // the mapped file itself stays unchanged
    fs::resize_file(file(64).string() + ".copy", size);
    fs::rename(file(64).string() + ".copy", file(64));
    expect_made_anew();
  }
  for (const std::uint64_t at : {0, 8, 16, 24, 28, 32, 36, 40, 1000}) {
    fs::copy_file(file(64), file(64).string() + ".copy");
    std::fstream copy(file(64).string() + ".copy", std::ios::in | std::ios::out | std::ios::binary);
    copy.seekg(std::streamoff(at));
    const int byte = copy.get();
    copy.seekp(std::streamoff(at));
    copy.put(char(byte ^ 0x21));
    copy.close();
    fs::rename(file(64).string() + ".copy", file(64));
    expect_made_anew();
  }
}

TEST_F(TextureStoreTest, ADiskThatFillsUpIsNamedAndNothingHalfWrittenStays) {
  const SmallDisk end(2000);
  EXPECT_THROW(load(64), IoError);
  for (const auto& entry : fs::directory_iterator(scratch)) EXPECT_EQ(entry.path().extension(), ".lock");
}

/// 2026-11-23: an image of a few bytes may require a texture of gigabytes.
TEST_F(TextureStoreTest, WhatTheDiskHasNoRoomForIsNotBegun) {
  {
    const ScratchPublication file(scratch / "x_large.texture");
    file.expect_room(1000);
    EXPECT_THROW(file.expect_room(std::uint64_t(1) << 60), IoError);
  }
  EXPECT_TRUE(fs::is_empty(scratch));
}

TEST_F(TextureStoreTest, AnImageThatIsNoneIsRefusedAsInMemory) {
  EXPECT_THROW(store.load(key(64), 1 << 20, [] { return EncodedImage{"bad.png", {1, 2, 3}}; }), InputError);
}

TEST_F(TextureStoreTest, SeveralRanksDecodeOnce) {
  std::atomic<int> decoded{0};
  std::vector<std::thread> ranks;
  for (int rank = 0; rank < 5; ++rank)
    ranks.emplace_back([&] {
      TextureStore of_rank(scratch, 1000);
      of_rank.load(key(64), 1 << 20, [&] {
        ++decoded;
        return image(64);
      });
    });
  for (std::thread& rank : ranks) rank.join();
  EXPECT_EQ(decoded, 1);
}

}  // namespace
}  // namespace gigabake
