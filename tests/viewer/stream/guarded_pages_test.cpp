// Producers of pages that fail, hang or return wrong data: the result is a clear error, no hole and no crash.
#include <chrono>
#include <condition_variable>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <memory>
#include <mutex>
#include <stdexcept>

#include "core/base/error.h"
#include "tests/viewer/ground_scene.h"
#include "viewer/pictures/frame_renderer.h"
#include "viewer/stream/page.h"

namespace gigabake {
namespace {

using testing::HasSubstr;

std::string answer_of(const PageSource& source, const PageKey& key) {
  try {
    source(key);
  } catch (const InputError& error) {
    return error.what();
  }
  return "a page";
}

/// Returns the answer of guarded_pages() after `lie` has changed the ground's pages.
template <class Lie>
std::string answer_to(const PageKey& key, const Lie& lie) {
  const VoxelScene scene = wide_ground();
  const PageSource true_pages = scene.pages();
  const PageSource liar = [&](const PageKey& asked) {
    Page page = true_pages(asked);
    lie(page);
    return page;
  };
  return answer_of(guarded_pages(liar, scene.description()), key);
}

constexpr PageKey rows_key{0, PageKey::node_rows, 0}, bricks_key{0, 0, 0};

TEST(GuardedPages, GiveWhatHoldsTogether) {
  EXPECT_EQ(answer_to(rows_key, [](Page&) {}), "a page");
  EXPECT_EQ(answer_to(bricks_key, [](Page&) {}), "a page");
}

TEST(GuardedPages, RefuseLies) {
  EXPECT_THAT(answer_to(rows_key, [](Page& p) { p.rows.clear(); }), HasSubstr("shard 0, nodes, block 0"));
  EXPECT_THAT(answer_to(rows_key, [](Page& p) { p.rows.resize(5000); }), HasSubstr("expected 1 to 4096 rows"));
  EXPECT_THAT(answer_to(rows_key, [](Page& p) { p.rows[0].kind = NodeKind(9); }), HasSubstr("unknown type"));
  EXPECT_THAT(answer_to(rows_key, [](Page& p) { p.rows[0].first_child = 0xffffffff; }), HasSubstr("beyond every"));
  EXPECT_THAT(answer_to(rows_key, [](Page& p) { p.bricks.mask.resize(8); }), HasSubstr("page of another type"));
  EXPECT_THAT(answer_to(bricks_key, [](Page& p) { p.bricks.mask.pop_back(); }), HasSubstr("level 0"));
  EXPECT_THAT(answer_to(bricks_key, [](Page& p) { p.bricks.mask[0] ^= 1; }), HasSubstr("first does not match"));
  EXPECT_THAT(answer_to(bricks_key, [](Page& p) { p.bricks.first.back() += 7; }), HasSubstr("first does not match"));
  EXPECT_THAT(answer_to(bricks_key, [](Page& p) { p.bricks.rgba.pop_back(); }), HasSubstr("4 bytes of rgba"));
  EXPECT_THAT(answer_to(bricks_key, [](Page& p) { p.bricks.normal.clear(); }), HasSubstr("normals"));
  EXPECT_THAT(answer_to(bricks_key, [](Page& p) { p.bricks.directional_coverage.resize(4); }), HasSubstr("facing"));
  const VoxelScene scene = wide_ground();
  EXPECT_THAT(answer_of(guarded_pages(scene.pages(), scene.description(), {.max_page_bytes = 100}), bricks_key),
              HasSubstr("expected at most 100"));
}

TEST(GuardedPages, SayWhyAProducerFailed) {
  const VoxelScene scene = wide_ground();
  const PageSource fails = [](const PageKey&) -> Page { throw std::runtime_error("the line is dead"); };
  EXPECT_THAT(answer_of(guarded_pages(fails, scene.description()), bricks_key), HasSubstr("the line is dead"));
  const PageSource throws_a_number = [](const PageKey&) -> Page { throw 7; };
  EXPECT_THAT(answer_of(guarded_pages(throws_a_number, scene.description()), bricks_key),
              HasSubstr("an unknown reason"));
}

TEST(GuardedPages, DoNotWaitForAProducerThatHangs) {
  struct Gate {
    std::mutex mutex;
    std::condition_variable opened;
    bool open = false;
  };
  const auto gate = std::make_shared<Gate>();
  const PageSource hangs = [gate](const PageKey&) -> Page {
    std::unique_lock lock(gate->mutex);
    gate->opened.wait(lock, [&] { return gate->open; });
    return {};
  };
  const VoxelScene scene = wide_ground();
  const PageSource guarded = guarded_pages(hangs, scene.description(), {.seconds = 0.05, .max_late = 2});
  EXPECT_THAT(answer_of(guarded, bricks_key), HasSubstr("no page within"));
  EXPECT_THAT(answer_of(guarded, bricks_key), HasSubstr("no page within"));
  EXPECT_THAT(answer_of(guarded, bricks_key), HasSubstr("not requested again"));
  const std::scoped_lock lock(gate->mutex);
  gate->open = true;
  gate->opened.notify_all();
}

/// An image of a scene with damaged pages has no holes: coarser levels replace the refused pages.
TEST(GuardedPages, OfALiarLeaveNoHoleInThePicture) {
  const VoxelScene scene = wide_ground();
  const PageSource true_pages = scene.pages();
  CameraOptions camera = view({64, 64, 90}, {64, 64.1, 10}).camera;
  const auto covered_by = [&](const std::function<void(const PageKey&, Page&)>& lie, bool& told) {
    const PageSource liar = [&](const PageKey& key) {
      Page page = true_pages(key);
      lie(key, page);
      return page;
    };
    FrameRenderer::Options options;
    options.threads = 2;
    FrameRenderer renderer(scene.description(), "scene.xml", liar, options);
    const Frame frame = renderer.render_complete({camera, ViewMode::albedo, {false, {0, 0, 0, 0}}});
    told = !renderer.problems().empty();
    int covered = 0;
    for (std::size_t i = 3; i < frame.picture.rgba.size(); i += 4) covered += frame.picture.rgba[i] > 250 ? 1 : 0;
    return covered;
  };
  bool told = false;
  const int whole = covered_by([](const PageKey&, Page&) {}, told);
  EXPECT_FALSE(told);
  EXPECT_GT(whole, 5000);
  EXPECT_GE(covered_by(
                [](const PageKey& key, Page& p) {
                  if (key.part == 0) p.bricks.rgba.clear();
                },
                told),
            whole);
  EXPECT_TRUE(told);
  // One page has fewer bricks than other pages refer to, then another page has fewer node rows.
  covered_by(
      [](const PageKey& key, Page& p) {
        if (key.part != 0 || p.bricks.first.size() < 3) return;
        p.bricks.mask.resize(8);
        p.bricks.first.resize(2);
        p.bricks.rgba.resize(4 * std::size_t(p.bricks.first[1]));
        p.bricks.normal.resize(2 * std::size_t(p.bricks.first[1]));
      },
      told);
  covered_by(
      [](const PageKey& key, Page& p) {
        if (key.part == PageKey::node_rows) p.rows.resize(2);
      },
      told);
}

}  // namespace
}  // namespace gigabake
