#include <gtest/gtest.h>

#include "core/octree/parameters.h"
#include "format/scene/xml/page_write.h"
#include "tests/format/shard/made_shard.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake {
namespace {

constexpr std::uint32_t tile_voxels = 16;  ///< edge of a cell
using Rgba = std::array<std::uint8_t, 4>;
constexpr Rgba green{60, 140, 60, 255}, red{200, 30, 30, 255};

/// Returns a hilly cell of one colour, raised by `rise` voxels.
Shard hill_cell(std::int64_t column, std::int64_t row, const Rgba& rgba, std::int64_t rise = 0) {
  std::vector<made::Voxel> voxels;
  const Vec3i64 min{column * tile_voxels, row * tile_voxels, 0};
  for (std::int64_t y = min[1]; y < min[1] + tile_voxels; ++y)
    for (std::int64_t x = min[0]; x < min[0] + tile_voxels; ++x)
      voxels.push_back({{x, y, 4 + rise + (x / 3 + y / 5) % 4}, rgba, {0, 0}});
  return made::shard_of(voxels, min, tile_voxels);
}

FrameRenderer::Options with_one_thread() {
  FrameRenderer::Options options;
  options.threads = 1;
  return options;
}

/// A scene of `edge` × `edge` cells in a file, of which the test replaces cells.
class SceneExchangeTest : public ::testing::Test {
 protected:
  void write(int edge) {
    std::vector<Shard> shards;
    for (int row = 0; row < edge; ++row)
      for (int column = 0; column < edge; ++column) shards.push_back(hill_cell(column, row, green));
    scene = made::write_scene_of(path(), shards);
  }
  /// Writes a new shard of a cell and returns its entry.
  SceneCell write_cell(const Shard& shard) {
    SceneCell cell = made::write_shard_of(folder / "new" / "scene.xml", shard);
    const std::string file = "shards/" + std::to_string(++files) + ".h5";
    std::filesystem::rename(folder / "new" / cell.file, folder / file);
    cell.file = file;
    return cell;
  }
  void replace(std::size_t at, const Shard& shard) {
    scene.cells[at] = write_cell(shard);
    write_scene(path(), scene);
  }
  std::filesystem::path path() const { return folder / "scene.xml"; }

  /// Returns the view of the whole scene that a new renderer has.
  View view_of_all(const FrameRenderer& renderer) const {
    View view;
    view.camera.width = 160;
    view.camera.height = 120;
    view.camera = renderer.framed(view.camera);
    return view;
  }
  static void finish(FrameRenderer& renderer) {
    while (!renderer.advance_exchange(1)) {
    }
  }
  Picture exact(const View& view) const {
    return FrameRenderer(path(), with_one_thread()).render_complete(view).picture;
  }

  made::TempFolder folder;
  SceneDescription scene;
  int files = 0;
};

TEST_F(SceneExchangeTest, EndsWithTheImageOfTheNewScene) {
  write(4);
  FrameRenderer renderer(path(), with_one_thread());
  const View view = view_of_all(renderer);
  const Picture before = renderer.render_complete(view).picture;
  for (const std::int64_t rise : {0, 3, -4}) {
    replace(5, hill_cell(1, 1, red, rise));
    ASSERT_TRUE(renderer.replace_scene());
    EXPECT_TRUE(renderer.has_exchange());
    finish(renderer);
    EXPECT_FALSE(renderer.has_exchange());
    const Picture after = renderer.render_complete(view).picture;
    EXPECT_NE(after.rgba, before.rgba);
    EXPECT_EQ(after.rgba, exact(view).rgba) << rise;
    EXPECT_EQ(after.depth, exact(view).depth) << rise;
  }
}

/// Pages with few cells, so that a small scene has pages below pages.
constexpr PageRule small_pages{4, 2, 2};

TEST_F(SceneExchangeTest, ExchangesCellsOfScenesWithPages) {
  write(8);
  write_scene(path(), scene, small_pages);
  ASSERT_FALSE(PagedScene(path()).root().pages.empty());
  FrameRenderer renderer(path(), with_one_thread());
  const View view = view_of_all(renderer);
  const Picture before = renderer.render_complete(view).picture;
  const std::uint64_t all = renderer.uploads();
  for (const std::int64_t rise : {0, 3, -4}) {
    scene.cells[13] = write_cell(hill_cell(5, 1, red, rise));
    write_scene(path(), scene, small_pages);
    const std::uint64_t uploads = renderer.uploads();
    ASSERT_TRUE(renderer.replace_scene());
    finish(renderer);
    const Picture after = renderer.render_complete(view).picture;
    EXPECT_NE(after.rgba, before.rgba);
    EXPECT_EQ(after.rgba, exact(view).rgba) << rise;
    EXPECT_LE(renderer.uploads() - uploads, all / 4);
  }
}

TEST_F(SceneExchangeTest, OpensScenesWithPagesAgainIfCellsAppearOrPagesAreLost) {
  write(8);
  write_scene(path(), scene, small_pages);
  FrameRenderer renderer(path(), with_one_thread());
  scene.cells.push_back(write_cell(hill_cell(8, 8, red)));
  write_scene(path(), scene, small_pages);
  EXPECT_FALSE(renderer.replace_scene());
  scene.cells.pop_back();
  scene.cells[13] = write_cell(hill_cell(5, 1, red));
  write_scene(path(), scene, small_pages);
  EXPECT_TRUE(renderer.replace_scene());
  FrameRenderer other(path(), with_one_thread());
  scene.cells[13] = write_cell(hill_cell(5, 1, green, 1));
  write_scene(path(), scene, small_pages);
  remove_unused_pages(path());
  EXPECT_FALSE(other.replace_scene()) << "the pages of the previous scene are removed";
}

// The re-bake of one of 1,000 cells.
TEST_F(SceneExchangeTest, UploadsAtMostTwoPercentAndKeepsTheMemoryBound) {
  write(32);
  FrameRenderer::Options options = with_one_thread();
  options.memory_bytes = std::uint64_t(96) << 20;
  FrameRenderer renderer(path(), options);
  const View view = view_of_all(renderer);
  renderer.render_complete(view);
  const std::uint64_t all = renderer.uploads();
  for (const std::int64_t rise : {1, 2}) {
    replace(500, hill_cell(500 % 32, 500 / 32, red, rise));
    const std::uint64_t uploads = renderer.uploads();
    ASSERT_TRUE(renderer.replace_scene());
    Frame frame;
    do {
      frame = renderer.draw(view, 0.01);
      EXPECT_LE(frame.stats.bytes_held, frame.stats.bytes_allowed);
    } while (!renderer.advance_exchange(0.002));
    frame = renderer.render_complete(view);
    EXPECT_LE(frame.stats.bytes_held, frame.stats.bytes_allowed);
    EXPECT_EQ(frame.picture.rgba, exact(view).rgba);
    EXPECT_GT(renderer.uploads(), uploads);
    EXPECT_LE(renderer.uploads() - uploads, all / 50) << all;
  }
}

TEST_F(SceneExchangeTest, UntilTheEndImagesShowThePreviousScene) {
  write(4);
  FrameRenderer renderer(path(), with_one_thread());
  const View view = view_of_all(renderer);
  const Picture before = renderer.render_complete(view).picture;
  replace(5, hill_cell(1, 1, red));
  ASSERT_TRUE(renderer.replace_scene());
  int frames = 0;
  do {
    EXPECT_EQ(renderer.draw(view, 1).picture.rgba, before.rgba);
    ++frames;
  } while (!renderer.advance_exchange(0));
  EXPECT_GT(frames, 1) << "pages of the new shard are read between frames";
}

TEST_F(SceneExchangeTest, TheFirstImageAfterwardsHasNoHoleAndOneStateOfTheCell) {
  write(4);
  FrameRenderer renderer(path(), with_one_thread());
  const View view = view_of_all(renderer);
  const Picture before = renderer.render_complete(view).picture;
  for (std::size_t i = 0; i < scene.cells.size(); ++i) scene.cells[i] = write_cell(hill_cell(i % 4, i / 4, red));
  write_scene(path(), scene);
  ASSERT_TRUE(renderer.replace_scene());
  finish(renderer);
  const Picture first = renderer.draw(view, 0).picture;
  for (std::size_t p = 0; p < before.depth.size(); ++p) {
    if (before.depth[p] > 1e30f || before.rgba[4 * p + 3] != 255) continue;
    EXPECT_LT(first.depth[p], 1e30f) << "hole at " << p;
    EXPECT_GT(first.rgba[4 * p], first.rgba[4 * p + 1]) << "previous colour at " << p;
  }
}

TEST_F(SceneExchangeTest, KeepsThePagesAndBricksOfOtherCells) {
  write(32);
  FrameRenderer renderer(path(), with_one_thread());
  View view = view_of_all(renderer);
  view.camera.pixel_error = 1.0 / 16;
  const Frame before = renderer.render_complete(view);
  const std::uint64_t uploads = renderer.uploads();
  ASSERT_GT(uploads, 4000u);
  replace(500, hill_cell(500 % 32, 500 / 32, red));
  ASSERT_TRUE(renderer.replace_scene());
  finish(renderer);
  const Frame after = renderer.render_complete(view);
  EXPECT_EQ(after.picture.rgba, exact(view).rgba);
  EXPECT_LE(renderer.uploads() - uploads, uploads / 50) << "of " << uploads;
  EXPECT_LE(after.stats.files_opened - before.stats.files_opened, 10u) << "the new shard and its neighbours";
  EXPECT_LE(after.stats.bytes_held, after.stats.bytes_allowed);
}

TEST_F(SceneExchangeTest, AnEqualSceneExchangesNothing) {
  write(4);
  FrameRenderer renderer(path(), with_one_thread());
  const View view = view_of_all(renderer);
  const Frame before = renderer.render_complete(view);
  const std::uint64_t uploads = renderer.uploads();
  replace(3, hill_cell(3, 0, green));  // another file of the same content
  ASSERT_TRUE(renderer.replace_scene());
  finish(renderer);
  EXPECT_EQ(renderer.render_complete(view).picture.rgba, before.picture.rgba);
  EXPECT_EQ(renderer.uploads(), uploads);
}

TEST_F(SceneExchangeTest, ManyReplacementsInARowEndWithTheLast) {
  write(4);
  FrameRenderer renderer(path(), with_one_thread());
  const View view = view_of_all(renderer);
  renderer.render_complete(view);
  for (int i = 0; i < 12; ++i) {
    replace(std::size_t(i), hill_cell(i % 4, i / 4, red, i % 3));
    ASSERT_TRUE(renderer.replace_scene());
    renderer.advance_exchange(0);
    if (!renderer.has_exchange()) continue;
    renderer.draw(view, 0.001);
  }
  if (renderer.has_exchange()) finish(renderer);
  EXPECT_EQ(renderer.render_complete(view).picture.rgba, exact(view).rgba);
}

TEST_F(SceneExchangeTest, AChangeOfTheModeDuringAnExchangeLosesNothing) {
  write(4);
  FrameRenderer renderer(path(), with_one_thread());
  View view = view_of_all(renderer);
  renderer.render_complete(view);
  replace(5, hill_cell(1, 1, red));
  ASSERT_TRUE(renderer.replace_scene());
  view.mode = ViewMode::cell;
  renderer.draw(view, 1);
  finish(renderer);
  view.mode = ViewMode::albedo;
  EXPECT_EQ(renderer.render_complete(view).picture.rgba, exact(view).rgba);
}

TEST_F(SceneExchangeTest, OtherCellsOrAnotherLatticeMustBeOpenedAnew) {
  write(4);
  FrameRenderer renderer(path(), with_one_thread());
  const std::vector<SceneCell> all = scene.cells;
  scene.cells.pop_back();
  write_scene(path(), scene);
  EXPECT_FALSE(renderer.replace_scene());
  scene.cells = all;
  scene.voxel_size_m *= 2;
  write_scene(path(), scene);
  EXPECT_FALSE(renderer.replace_scene());
}

TEST_F(SceneExchangeTest, InPoolsThatAreTooSmallTheImageIsRight) {
  write(8);
  FrameRenderer::Options options = with_one_thread();
  options.memory_bytes = 400 << 10;
  FrameRenderer renderer(path(), options);
  const View view = view_of_all(renderer);
  renderer.render_complete(view);
  replace(20, hill_cell(4, 2, red));
  ASSERT_TRUE(renderer.replace_scene());
  finish(renderer);
  EXPECT_EQ(renderer.render_complete(view).picture.rgba, exact(view).rgba);
}

}  // namespace
}  // namespace gigabake
