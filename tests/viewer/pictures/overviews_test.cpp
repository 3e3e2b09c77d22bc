// Scenes that are rendered from their root down look like a single cell with the same voxels. They have no holes at
// damaged shards.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <mutex>
#include <set>
#include <span>
#include <string>

#include "core/base/error.h"
#include "tests/format/shard/made_shard.h"
#include "tests/viewer/voxel_scene.h"
#include "viewer/pictures/frame_renderer.h"
#include "viewer/pictures/render.h"
#include "viewer/stream/numbered_shards.h"
#include "viewer/stream/scene_stream.h"

namespace gigabake {
namespace {

constexpr std::int64_t ground_edge = 128;  ///< edge of the scene in voxels

/// Paints rolling ground, two voxels thick, and posts.
std::optional<Paint> hills(std::int64_t x, std::int64_t y, std::int64_t z) {
  if (x < 0 || y < 0 || x >= ground_edge || y >= ground_edge) return {};
  const double ground = 30 + 9 * std::sin(double(x) / 13) + 7 * std::cos(double(y) / 11);
  const bool post = x % 32 < 2 && y % 32 < 2 && double(z) < ground + 10;
  if (double(z) < ground - 2 || (double(z) >= ground && !post)) return {};
  return Paint{{std::uint8_t(60 + x), std::uint8_t(90 + (x ^ y) % 64), std::uint8_t(200 - y), 255}, {0, 0}};
}

VoxelScene whole() {
  VoxelScene scene(ground_edge);
  scene.add_cell(hills, {0, 0, 0});
  return scene;
}

/// Returns a scene of cells of 8³ voxels, overviews of 64³, and a root of 128³ whose only level is level 4.
VoxelScene paint_in_three_tiers() {
  VoxelScene scene(8);
  scene.add_cells(hills, {0, 0, 0}, ground_edge);
  for (std::int64_t at = 0; at < 8; ++at)
    scene.add_overview(hills, {64 * (at & 1), 64 * (at >> 1 & 1), 64 * (at >> 2)}, 64, 1);
  scene.add_overview(hills, {0, 0, 0}, ground_edge, 4);
  return scene;
}

const VoxelScene& in_three_tiers() {
  static const VoxelScene scene = paint_in_three_tiers();
  return scene;
}

/// Returns a scene of cells of 16³ voxels at multiples of 8 along z. Overviews of 128³ duplicate level 1 of the cells,
/// and a root duplicates all levels of the overviews.
VoxelScene paint_with_copies() {
  VoxelScene scene(16);
  for (std::int64_t y = 0; y < 8; ++y)
    for (std::int64_t x = 0; x < 8; ++x)
      for (std::int64_t z = -1; z < 8; ++z) scene.add_cell(hills, {16 * x, 16 * y, 16 * z + 8 * ((x + y) % 2)});
  for (const std::int64_t z : {-128, 0}) scene.add_overview(hills, {0, 0, z}, 128, 1, 1);
  scene.add_overview(hills, {-128, 0, -128}, 256, 1, 4);
  return scene;
}

const VoxelScene& with_copies() {
  static const VoxelScene scene = paint_with_copies();
  return scene;
}

/// Returns a scene of cells of 32³ voxels at multiples of 8 along z. The root begins at multiples of half its edge.
VoxelScene in_stacks() {
  VoxelScene scene(32);
  for (std::int64_t y = 0; y < 4; ++y)
    for (std::int64_t x = 0; x < 4; ++x)
      for (std::int64_t z = -1; z < 3; ++z) scene.add_cell(hills, {32 * x, 32 * y, 32 * z + 8 * ((x + 3 * y) % 4)});
  scene.add_overview(hills, {-128, 0, -128}, 256, 3);
  return scene;
}

struct Eye {
  std::array<double, 3> eye_m, target_m;
  double pixel_error;
};
/// Eyes from near to far. Their views show levels 0 to 4.
const Eye eyes[] = {{{20, 30, 60}, {70, 80, 30}, 1},
                    {{64, 60, 100}, {64, 64, 30}, 4},
                    {{70, 60, 120}, {64, 64, 20}, 12},
                    {{-200, -160, 260}, {64, 64, 20}, 4},
                    {{300, -500, 700}, {64, 64, 20}, 6}};

View at(const Eye& eye, ViewMode mode = ViewMode::lit) {
  View there{view(eye.eye_m, eye.target_m, 96).camera, mode, {false, {0, 0, 0, 0}}};
  there.camera.pixel_error = eye.pixel_error;
  return there;
}

FrameRenderer renderer_of(const VoxelScene& scene, const PageSource& pages) {
  FrameRenderer::Options options;
  options.threads = 2;
  options.memory_bytes = std::uint64_t(1) << 27;
  return FrameRenderer(scene.description(), "scene.xml", pages, options);
}

std::size_t mostly_covered_pixels(const Picture& picture) {
  std::size_t covered = 0;
  for (std::size_t i = 3; i < picture.rgba.size(); i += 4) covered += picture.rgba[i] > 127;
  return covered;
}

TEST(DrawnFromOverviews, IsWhatOneCellOfAllShows) {
  const VoxelScene one = whole();
  const VoxelScene& many = in_three_tiers();
  ASSERT_EQ(many.description().overviews.size(), 5u) << "four overviews hold ground, and the root";
  FrameRenderer expected = renderer_of(one, one.pages()), drawn = renderer_of(many, many.pages());
  for (const ViewMode mode : {ViewMode::lit, ViewMode::lod})
    for (const Eye& eye : eyes) {
      const Picture a = expected.render_complete(at(eye, mode)).picture,
                    b = drawn.render_complete(at(eye, mode)).picture;
      EXPECT_EQ(a.rgba, b.rgba) << name_of(mode) << " from " << eye.eye_m[2];
      for (std::size_t i = 0; i < a.depth.size(); ++i) EXPECT_NEAR(a.depth[i], b.depth[i], 0.01) << "voxels";
      EXPECT_GT(mostly_covered_pixels(a), a.depth.size() / 40);
    }
}

/// Expects similar images of both scenes, for the eyes that are near enough for the coarsest level of the single cell.
void expect_alike(const VoxelScene& one, const VoxelScene& many) {
  FrameRenderer expected = renderer_of(one, one.pages()), drawn = renderer_of(many, many.pages());
  for (const Eye& eye : std::span(eyes).first(4)) {
    const Picture a = expected.render_complete(at(eye)).picture, b = drawn.render_complete(at(eye)).picture;
    int maximum = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) maximum = std::max(maximum, std::abs(a.rgba[i] - b.rgba[i]));
    EXPECT_LE(maximum, 2) << "from " << eye.eye_m[2];
  }
}

TEST(DrawnFromOverviews, ShowsNoSeamWhereStacksOfCellsBeginAnywhere) { expect_alike(whole(), in_stacks()); }

/// Renders an image and returns the shards that it read. Expects more than `min_covered` pixels to show the scene.
std::set<std::uint32_t> shards_read(const VoxelScene& scene, const Eye& eye, std::size_t min_covered) {
  std::mutex mutex;
  std::set<std::uint32_t> shards;
  FrameRenderer renderer = renderer_of(scene, [&, inner = scene.pages()](const PageKey& key) {
    const std::lock_guard lock(mutex);
    shards.insert(key.shard);
    return inner(key);
  });
  EXPECT_GT(mostly_covered_pixels(renderer.render_complete(at(eye)).picture), min_covered);
  return shards;
}

std::set<std::uint32_t> root_alone(const VoxelScene& scene) {
  return {std::uint32_t(scene.description().cells.size() + scene.description().overviews.size() - 1)};
}

TEST(DrawnFromOverviews, ReadsTheRootAloneOfWhatIsFarAway) {
  const VoxelScene& scene = in_three_tiers();
  EXPECT_EQ(shards_read(scene, {{64, 60, 4000}, {64, 64, 20}, 4}, 2), root_alone(scene));
}

TEST(DrawnFromOverviews, WithCopiesIsWhatOneCellOfAllShows) { expect_alike(whole(), with_copies()); }

TEST(DrawnFromOverviews, ReadsCopiesInPlaceOfCells) {
  const VoxelScene& scene = with_copies();
  EXPECT_EQ(shards_read(scene, eyes[3], 100), root_alone(scene)) << "whose copies reach down to level 1";
}

/// Returns a source of pages in which the pages of one shard cannot be read.
PageSource damaged(const VoxelScene& scene, std::uint32_t shard) {
  return [inner = scene.pages(), shard](const PageKey& key) {
    if (key.shard == shard) throw InputError("shards/damaged.h5", "", "no such file");
    return inner(key);
  };
}

std::size_t different_pixels(const Picture& a, const Picture& b) {
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.depth.size(); ++i) different += a.depth[i] != b.depth[i];
  return different;
}

TEST(DrawnFromOverviews, ShowsTheOverviewWhereACellIsDamaged) {
  const VoxelScene& scene = in_three_tiers();
  const View near = at({{36, 36, 70}, {36.1, 36, 30}, 1});
  const Picture expected = renderer_of(scene, scene.pages()).render_complete(near).picture;
  std::uint32_t below = 0;  // shard below the camera
  for (std::uint32_t c = 0; c < scene.description().cells.size(); ++c)
    if (scene.description().cells[c].lattice_min[0] == 32 && scene.description().cells[c].lattice_min[1] == 32)
      below = c;
  FrameRenderer renderer = renderer_of(scene, damaged(scene, below));
  const Picture drawn = renderer.render_complete(near).picture;
  EXPECT_EQ(renderer.problems(), std::vector<std::string>{"shards/damaged.h5: no such file"});
  EXPECT_EQ(mostly_covered_pixels(drawn), mostly_covered_pixels(expected)) << "there is no hole";
  EXPECT_GT(different_pixels(drawn, expected), 0u);
  EXPECT_LT(different_pixels(drawn, expected), expected.depth.size() / 4) << "the other cells are unchanged";
}

TEST(DrawnFromOverviews, ShowsTheCellsWhereAnOverviewIsDamaged) {
  const VoxelScene& scene = in_three_tiers();
  const auto first = std::uint32_t(scene.description().cells.size());
  const auto last = first + std::uint32_t(scene.description().overviews.size()) - 1;
  for (const std::uint32_t overview : {first, last}) {
    FrameRenderer whole = renderer_of(scene, scene.pages()), renderer = renderer_of(scene, damaged(scene, overview));
    const View near = at(eyes[0]);
    EXPECT_EQ(renderer.render_complete(near).picture.rgba, whole.render_complete(near).picture.rgba);
    EXPECT_EQ(renderer.problems().size(), overview == last ? 0u : 1u) << "of the root nothing is needed from near";
    const View far = at({{64, 60, 300}, {64, 64, 20}, 6});
    const std::size_t covered = mostly_covered_pixels(whole.render_complete(far).picture);
    if (overview == last) continue;  // the root has no fallback
    EXPECT_GE(mostly_covered_pixels(renderer.render_complete(far).picture), covered * 9 / 10);
  }
}

TEST(DrawnFromOverviews, TakesFromItsChildrenWhatADamagedOverviewHasCopiesOf) {
  const VoxelScene& scene = with_copies();
  const auto first = std::uint32_t(scene.description().cells.size());
  const auto root = first + std::uint32_t(scene.description().overviews.size()) - 1;
  FrameRenderer whole = renderer_of(scene, scene.pages()), renderer = renderer_of(scene, damaged(scene, root));
  for (const std::size_t eye : {1u, 3u}) {  // these eyes see levels 1 to 3
    EXPECT_EQ(renderer.render_complete(at(eyes[eye])).picture.rgba, whole.render_complete(at(eyes[eye])).picture.rgba)
        << eye;
    EXPECT_EQ(renderer.problems().size(), 1u) << "one line reports the damage";
  }
}

TEST(DrawnFromOverviews, TakesCellsWhereAnOverviewIsMissing) {
  const VoxelScene& scene = in_three_tiers();
  SceneDescription description = scene.description();
  description.overviews.erase(description.overviews.begin());
  description.losses.push_back({"parent p", "was not baked"});
  const auto draw = [&](const SceneDescription& described) {
    FrameRenderer renderer(described, "scene.xml", scene.pages(), {});
    return renderer.render_complete(at(eyes[0])).picture;
  };
  EXPECT_EQ(draw(description).rgba, draw(scene.description()).rgba);
}

/// Returns a source that reads index pages from `numbers` and all other pages from memory. The shards in memory have
/// other numbers than in `numbers`.
PageSource with_pages_of(const std::shared_ptr<NumberedShards>& numbers, const VoxelScene& scene) {
  return [numbers, inner = scene.pages()](PageKey key) {
    if (key.part <= PageKey::listing) return numbers->listing(key);
    key.shard = std::uint32_t(std::stoul(numbers->shard(key.shard).name.substr(2)) - 1);
    return inner(key);
  };
}

/// The scene of paint_in_three_tiers() with an index of pages on disk. Its shards are in memory.
struct InPages {
  InPages() {
    SceneDescription description = scene.description();
    for (std::vector<SceneCell>* shards : {&description.cells, &description.overviews})
      for (SceneCell& shard : *shards) {
        shard.voxels.assign(shard.lods, 1);
        shard.content_hash.assign(shard.lods, {1, 2});
      }
    write_scene(folder / "scene.xml", description, {4, 2, 8});
  }

  struct Drawn {
    std::vector<std::uint8_t> rgba;
    std::vector<std::string> problems;
    std::size_t trees;
  };
  Drawn drawn(const PictureOptions& options) const {
    const auto opened = std::make_shared<const PagedScene>(folder / "scene.xml");
    const auto numbers = std::make_shared<NumberedShards>(opened, nullptr);
    const ThreadPool policy(2);
    SceneStream::Options wishes;
    wishes.light = options.light;
    SceneStream stream(*opened, with_pages_of(numbers, scene), wishes, policy);
    const kernels::CastCamera camera = make_camera(options.camera, *opened);
    std::vector<std::uint8_t> rgba = render(stream, camera, options.background).rgba;
    return {std::move(rgba), stream.problems(), stream.layout().cells.size()};
  }

  const VoxelScene& scene = in_three_tiers();
  made::TempFolder folder;
};

TEST(DrawnFromOverviews, FindsItsCellsAndOverviewsInThePagesOfTheScene) {
  const InPages in_pages;
  const PagedScene opened(in_pages.folder / "scene.xml");
  ASSERT_NE(opened.root().pages.at(0).groups, 0u) << "two levels of pages";
  ASSERT_LT(opened.root().overviews.size(), opened.totals().overviews) << "pages list overviews";
  const PictureOptions options = view({20, 30, 60}, {70, 80, 30});
  const InPages::Drawn drawn = in_pages.drawn(options);
  EXPECT_EQ(drawn.rgba, take(in_pages.scene, options).rgba);
  EXPECT_EQ(drawn.problems, std::vector<std::string>());
  EXPECT_EQ(drawn.trees, 8u);
}

TEST(DrawnFromOverviews, IsDrawnCoarserWhereAPageThatListsOverviewsIsGone) {
  const InPages in_pages;
  const PagedScene opened(in_pages.folder / "scene.xml");
  const std::vector<PageReference>& pages = opened.root().pages;
  const auto lost = std::ranges::find_if(pages, [](const PageReference& page) { return page.totals.overviews != 0; });
  ASSERT_NE(lost, pages.end());
  std::filesystem::remove(in_pages.folder / lost->file);
  const PictureOptions options = view({20, 30, 60}, {70, 80, 30});
  const InPages::Drawn drawn = in_pages.drawn(options);
  const std::vector<std::uint8_t> whole = take(in_pages.scene, options).rgba;
  ASSERT_EQ(drawn.problems.size(), 1u);
  EXPECT_NE(drawn.problems[0].find(lost->file), std::string::npos) << drawn.problems[0];
  std::size_t opaque = 0, holes = 0;
  for (std::size_t p = 3; p < whole.size(); p += 4) {
    opaque += whole[p] > 250;
    holes += whole[p] > 250 && drawn.rgba[p] < 128;
  }
  EXPECT_NE(drawn.rgba, whole);
  EXPECT_LE(50 * holes, opaque) << holes << " holes in " << opaque << " pixels";
}

}  // namespace
}  // namespace gigabake
