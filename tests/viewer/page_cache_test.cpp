#include "viewer/page_cache.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>

#include "format/error.h"
#include "voxel_scene.h"

namespace gigabake {
namespace {

Painter ground() {
  return [](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
    if (z != 12 + (x + y) % 3) return {};
    return Paint{{100, 150, 50, 255}, {}};
  };
}

/// Four by four cells of 32 m.
VoxelScene wide_ground() {
  VoxelScene scene(32);
  for (std::int64_t y = 0; y < 128; y += 32)
    for (std::int64_t x = 0; x < 128; x += 32) scene.add_cell(ground(), {x, y, 0});
  return scene;
}

/// A reader that keeps a list of what was asked for.
struct Witness {
  std::set<std::size_t> cells;
  std::multiset<int> lods;

  CellReader watch(const VoxelScene& scene) {
    const CellReader inner = scene.reader();
    return {[this, inner](std::size_t cell) {
              cells.insert(cell);
              return inner.nodes(cell);
            },
            [this, inner](std::size_t cell, int lod) {
              lods.insert(lod);
              return inner.level(cell, lod);
            }};
  }
};

Picture take_watched(const VoxelScene& scene, const PictureOptions& options, Witness& witness) {
  const kernels::CpuPolicy policy(1);
  PageCache::Options cache;
  cache.memory_bytes = options.memory_bytes;
  PageCache pages(scene.description(), "scene.xml", witness.watch(scene), cache, policy);
  return render(pages, make_camera(options.camera, scene.description(), scene.reader()), options.background, policy);
}

TEST(PageCache, LoadsOnlyTheCoarsestLevelOfWhatIsFarAway) {
  const VoxelScene scene = wide_ground();
  PictureOptions options = view({64, 64, 4000}, {64, 64, 0}, 300);
  Witness witness;
  take_watched(scene, options, witness);
  EXPECT_EQ(witness.cells.size(), 16u);
  EXPECT_EQ(std::set<int>(witness.lods.begin(), witness.lods.end()), std::set<int>{2});
}

TEST(PageCache, LeavesOutCellsThatNoRayReaches) {
  const VoxelScene scene = wide_ground();
  PictureOptions options = view({40, 40, 90}, {40, 40, 0}, 32);
  options.camera.fovy_deg = 5;
  Witness witness;
  take_watched(scene, options, witness);
  EXPECT_EQ(witness.cells.size(), 1u);
  EXPECT_EQ(witness.lods.count(0), 1u);
  EXPECT_EQ(witness.lods.size(), 1u);
}

TEST(PageCache, ReadsEachPageOnceWhereMemoryIsEnoughAndMoreOftenWhereItIsNot) {
  const VoxelScene scene = wide_ground();
  PictureOptions options = view({-20, -20, 40}, {64, 64, 0}, 300);  // two tiles of rays a side
  Witness enough, little;
  const Picture expected = take_watched(scene, options, enough);
  options.memory_bytes = 20000;
  EXPECT_EQ(take_watched(scene, options, little).rgba, expected.rgba);
  EXPECT_GT(little.lods.size(), enough.lods.size());
}

TEST(PageCache, StaysNearItsBudget) {
  const VoxelScene scene = wide_ground();
  const kernels::CpuPolicy policy(1);
  PageCache::Options options;
  options.memory_bytes = 100000;
  PageCache pages(scene.description(), "scene.xml", scene.reader(), options, policy);
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t cell = 0; cell < 16; ++cell) nodes.push_back(kernels::node_page(cell));
  pages.begin_pass();
  pages.load(nodes);
  std::uint64_t largest = 0;
  for (std::uint32_t cell = 0; cell < 16; ++cell) {
    pages.begin_pass();
    pages.load({kernels::node_page(cell)});
    const std::uint64_t before = pages.counts().peak_bytes;
    pages.load({kernels::level_page(cell, 0)});
    largest = std::max(largest, pages.counts().peak_bytes - before);
  }
  EXPECT_LE(pages.counts().peak_bytes, options.memory_bytes + 40000);
  EXPECT_GT(pages.counts().loads, 32u);
}

std::string complaint(VoxelScene scene, const PictureOptions& options = view({64, 64, 300}, {64, 64, 0}, 16)) {
  try {
    take(scene, options);
  } catch (const InputError& e) {
    return e.what();
  }
  return "none";
}

TEST(PageCache, NamesTheShardWhoseTreeIsBroken) {
  VoxelScene scene = wide_ground();
  scene.shards()[6].nodes.first_child[0] = 4000000;
  EXPECT_THAT(complaint(scene), testing::StartsWith("c_7.h5: nodes: a node's children are out of range"));
  scene = wide_ground();
  scene.shards()[3].nodes.lod[0] = 9;
  EXPECT_THAT(complaint(scene), testing::StartsWith("c_4.h5: nodes: the first node is not the root"));
  scene = wide_ground();
  scene.shards()[3].nodes.value.pop_back();
  EXPECT_THAT(complaint(scene), testing::StartsWith("c_4.h5: nodes: the node table's columns differ"));
}

TEST(PageCache, NamesTheLevelThatDoesNotFitItsTree) {
  for (int damage = 0; damage < 4; ++damage) {
    VoxelScene scene = wide_ground();
    for (BrickLevel& level : scene.shards()[5].levels) {
      if (damage == 0) level.first.back() += 1;
      if (damage == 1) level.mask[0] ^= 1u << 3;
      if (damage == 2) level.rgba.resize(level.rgba.size() - 4);
      if (damage == 3) level.mask.resize(level.mask.size() - 8);
    }
    EXPECT_THAT(complaint(scene), testing::StartsWith("c_6.h5: lod_")) << "damage " << damage;
  }
}

/// What lay_out_cells() says to a scene of two cells that was changed.
std::string layout_complaint(const std::function<void(SceneDescription&)>& change) {
  VoxelScene scene(32);
  for (const std::int64_t x : {0, 32}) scene.add_cell(ground(), {x, 0, 0});
  SceneDescription description = scene.description();
  change(description);
  try {
    lay_out_cells(description, "here/scene.xml");
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
              HasSubstr("2^31 columns"));
}

}  // namespace
}  // namespace gigabake
