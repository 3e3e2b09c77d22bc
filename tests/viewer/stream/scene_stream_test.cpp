#include "viewer/stream/scene_stream.h"

#include <array>
#include <functional>
#include <future>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mutex>
#include <set>

#include "core/base/error.h"
#include "tests/viewer/ground_scene.h"
#include "viewer/light/sky.h"
#include "viewer/pictures/render.h"

namespace gigabake {
namespace {

/// A source that records all requests.
struct Witness {
  std::mutex mutex;
  std::set<std::uint32_t> cells;  ///< cells whose bricks were requested
  std::set<int> lods;
  std::multiset<PageKey> pages;

  PageSource watch(const VoxelScene& scene) {
    return [this, inner = scene.pages()](const PageKey& key) {
      const std::lock_guard lock(mutex);
      pages.insert(key);
      if (key.part >= 0) {
        cells.insert(key.shard);
        lods.insert(key.part);
      }
      return inner(key);
    };
  }
};

Picture take_watched(const VoxelScene& scene, const PictureOptions& options, Witness& witness) {
  const ThreadPool pool(1);
  SceneStream::Options wishes;
  wishes.memory_bytes = options.memory_bytes;
  SceneStream stream(scene.paged(), witness.watch(scene), wishes, pool);
  return render(stream, make_camera(options.camera, scene.paged()), options.background);
}

TEST(SceneStream, ReadsOnlyTheCoarsestBricksOfWhatIsFarAway) {
  const VoxelScene scene = wide_ground();
  Witness witness;
  take_watched(scene, view({64, 64, 4000}, {64, 64, 0}, 300), witness);
  EXPECT_EQ(witness.cells.size(), 16u);
  EXPECT_EQ(witness.lods, std::set<int>{2});
}

TEST(SceneStream, ReadsOnlyTheCellsThatRaysReachAndTheirNeighbours) {
  const VoxelScene scene = wide_ground();
  PictureOptions options = view({40, 40, 90}, {40, 40, 0}, 32);
  options.camera.fovy_deg = 5;
  Witness witness;
  take_watched(scene, options, witness);
  EXPECT_LE(witness.cells.size(), 4u);
  EXPECT_EQ(witness.lods, std::set<int>{0});
}

TEST(SceneStream, ReadsEachPageOnceWhereMemoryIsEnoughAndMoreOftenWhereItIsNot) {
  const VoxelScene scene = wide_ground(64);
  PictureOptions options = view({-20, -20, 80}, {128, 128, 0}, 300);  // two render tiles per side
  Witness enough, little;
  const Picture expected = take_watched(scene, options, enough);
  EXPECT_EQ(std::set<PageKey>(enough.pages.begin(), enough.pages.end()).size(), enough.pages.size());
  options.memory_bytes = 300000;
  EXPECT_EQ(take_watched(scene, options, little).rgba, expected.rgba);
  EXPECT_GT(little.pages.size(), enough.pages.size());
}

TEST(SceneStream, AnswersRequestsAgainOnlyOnceTheirPagesAreResident) {
  const VoxelScene scene = wide_ground();
  const ThreadPool pool(1);
  std::promise<void> release;
  const PageSource held = [released = release.get_future().share(), inner = scene.pages()](const PageKey& key) {
    released.wait();
    return inner(key);
  };
  SceneStream stream(scene.paged(), held, {}, pool);
  const PictureOptions options = view({64, 64, 400}, {64, 64, 0}, 64);
  const kernels::CastCamera camera = make_camera(options.camera, scene.paged());
  stream.caster().start(camera, {0, 0, 64, 64});
  stream.caster().cast(0, 64 * 64, true, {});
  const std::vector<std::uint32_t> requested = stream.caster().requested();
  const auto serve = [&] { return stream.serve(requested, camera.eye, {}, {}); };
  ASSERT_FALSE(requested.empty());
  EXPECT_EQ(serve().answers, requested.size());
  const std::uint64_t queued = stream.page_counts().queued;
  const SceneStream::Served again = serve();
  EXPECT_EQ(again.answers, 0u);
  EXPECT_TRUE(again.misses_pages);
  EXPECT_EQ(stream.page_counts().queued, queued);
  release.set_value();
  ASSERT_TRUE(stream.settle(std::chrono::seconds(30)));
  stream.begin_pass();
  EXPECT_EQ(serve().answers, requested.size());
}

TEST(SceneStream, EntersPreparedAnswersIntoThePools) {
  const VoxelScene scene = wide_ground();
  const ThreadPool pool(2);
  const PictureOptions options = view({64, 64, 60}, {64, 64, 0}, 64);
  const kernels::CastCamera camera = make_camera(options.camera, scene.paged());
  SceneStream stream(scene.paged(), scene.pages(), {}, pool);
  kernels::Caster& caster = stream.caster();
  caster.start(camera, {0, 0, 64, 64});
  std::uint64_t uploads = 0;
  for (int pass = 0; caster.cast(0, 64 * 64, true, {}) > 0; ++pass) {
    ASSERT_LT(pass, 1000);
    const std::vector<std::uint32_t> requested = caster.requested();
    stream.prepare(requested, camera.eye);
    ASSERT_TRUE(stream.settle(std::chrono::seconds(30)));
    stream.prepare(requested, camera.eye);
    if (pass % 3 == 0) caster.cast(0, 64 * 64, true, {});  // prepare() must not change what rays see
    if (pass % 2 == 0) stream.begin_pass();
    uploads += stream.serve({}, camera.eye, {}, {caster.pass(), true}).uploads;
  }
  EXPECT_GT(uploads, 0u);
  EXPECT_EQ(uploads, stream.uploads());
  Picture picture = blank_picture(64, 64, PictureLight::srgb);
  caster.resolve(to_cast(options.background), pixels_of(picture));
  EXPECT_EQ(picture.rgba, take(scene, options).rgba);
}

/// Regression of 2026-11-29: with two pages in memory, a view never became complete. Pages that waiting requests shared
/// evicted each other, because nothing marked them as used.
TEST(SceneStream, EntersPreparedAnswersInLaterFramesIfTimeRunsOut) {
  const VoxelScene scene = wide_ground(64);
  const ThreadPool pool(2);
  SceneStream::Options little;
  little.memory_bytes = 230000;
  SceneStream stream(scene.paged(), scene.pages(), little, pool);
  kernels::Caster& caster = stream.caster();
  constexpr int edge = 150, rays = edge * edge;
  std::vector<PictureOptions> views;
  for (const std::array<double, 3>& eye : {std::array<double, 3>{-20, -20, 80}, {150, 20, 40}, {20, 160, 30}})
    views.push_back(view(eye, {64, 64, 0}, edge));
  std::uint64_t max_evicting = 0;
  for (int frame = 0; frame < 90; ++frame) {
    const kernels::CastCamera camera = make_camera(views[std::size_t(frame % 3)].camera, scene.paged());
    caster.start(camera, {0, 0, edge, edge});
    caster.cast(0, rays, true, {});
    const std::vector<std::uint32_t> requested = caster.requested();
    for (int time = 0; time < 2; ++time) {
      stream.prepare(requested, camera.eye);
      ASSERT_TRUE(stream.settle(std::chrono::seconds(30)));
    }
    stream.begin_pass();  // ends prepare()
    const std::uint64_t prepared = stream.prepared_uploads();
    const auto served = stream.serve(requested, camera.eye, [] { return true; }, {caster.pass(), false});
    max_evicting = std::max(max_evicting, served.uploads - prepared);
  }
  EXPECT_GT(max_evicting, 0u);
  EXPECT_LE(max_evicting, 64u) << "the answers that are entered between looks at the clock";
  for (const PictureOptions& options : views)
    EXPECT_EQ(render(stream, make_camera(options.camera, scene.paged()), options.background).rgba,
              take(scene, options).rgba);
}

/// A caster with a page pool copies voxels from pages. Its images have the same bits, also if the pool is a ring of few
/// pages. The host's caster has a page pool only in this test.
TEST(SceneStream, ShowsTheSameImagesWithPagePoolsOfAnySize) {
  const VoxelScene scene = wide_ground(128);  // its pages of lod 0 have 50,000 voxels
  const ThreadPool pool(2);
  const PictureOptions near = view({-20, -20, 80}, {256, 256, 0}, 300),
                       over = view({256, 256, 500}, {256, 256, 0}, 300);
  const auto stream_with = [&](std::uint64_t page_pool_bytes) {
    SceneStream::Options options;
    options.light = afternoon_light();
    options.memory_bytes = std::uint64_t(256) << 20;
    options.page_pool_bytes = page_pool_bytes;
    return std::make_unique<SceneStream>(scene.paged(), scene.pages(), options, pool);
  };
  const auto pictures_of = [&](SceneStream& stream) {
    std::vector<std::vector<std::uint8_t>> images;
    for (const PictureOptions* options : {&near, &over, &near})
      images.push_back(render(stream, make_camera(options->camera, scene.paged()), options->background).rgba);
    return images;
  };
  const auto without = stream_with(0);
  const auto expected = pictures_of(*without);
  for (const std::uint64_t bytes : {std::uint64_t(5) << 20, std::uint64_t(64) << 20}) {
    SCOPED_TRACE(bytes);
    const auto with = stream_with(bytes);
    EXPECT_EQ(pictures_of(*with), expected);
    EXPECT_GT(with->bytes_held(), without->bytes_held()) << "the page pool was used";
    EXPECT_EQ(with->uploads(), without->uploads());
  }
}

TEST(SceneStream, RefusesLessMemoryThanTheRootsTake) {
  const VoxelScene scene = wide_ground();
  PictureOptions options = view({-20, -20, 80}, {64, 64, 0}, 8);
  options.memory_bytes = 1000;
  EXPECT_THROW(take(scene, options), UsageError);
}

/// Returns the error of lay_out_cells() for a scene of two cells that `change` has modified.
std::string layout_complaint(const std::function<void(SceneDescription&)>& change) {
  VoxelScene scene(32);
  for (const std::int64_t x : {0, 32}) scene.add_cell(rippled_ground(), {x, 0, 0});
  SceneDescription description = scene.description();
  change(description);
  try {
    lay_out_cells(description.cells, "here/scene.xml");
  } catch (const InputError& e) {
    return e.what();
  }
  return "none";
}
TEST(CellLayout, NamesTheCellThatIsWrong) {
  using testing::HasSubstr;
  EXPECT_EQ(layout_complaint([](SceneDescription&) {}), "none");
  EXPECT_THAT(layout_complaint([](SceneDescription& s) { s.cells.clear(); }),
              HasSubstr("here/scene.xml: the scene has"));
  EXPECT_THAT(layout_complaint([](SceneDescription& s) { s.cells[1].cell_voxels = 64; }), HasSubstr("cell c_2: "));
  EXPECT_THAT(layout_complaint([](SceneDescription& s) { s.cells[0].cell_voxels = 33; }), HasSubstr("power of two"));
  EXPECT_THAT(layout_complaint([](SceneDescription& s) { s.cells[0].cell_voxels = 0; }), HasSubstr("power of two"));
  EXPECT_THAT(layout_complaint([](SceneDescription& s) { s.cells[0].lods = 40; }), HasSubstr("40 levels"));
  EXPECT_THAT(layout_complaint([](SceneDescription& s) { s.cells[1].lattice_min[0] = 33; }),
              HasSubstr("off the lattice"));
  EXPECT_THAT(layout_complaint([](SceneDescription& s) { s.cells[1].lattice_min[0] = INT64_MIN; }), HasSubstr("2^50"));
  EXPECT_THAT(layout_complaint([](SceneDescription& s) {
                s.cells[1].lattice_min = {0, 0, 24};
              }),
              HasSubstr("overlaps"));
  EXPECT_THAT(layout_complaint([](SceneDescription& s) { s.cells[1].lattice_min[0] = std::int64_t(1) << 40; }),
              HasSubstr("2^33 voxels"));
}

}  // namespace
}  // namespace gigabake
