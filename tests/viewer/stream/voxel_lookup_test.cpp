// Queries of a scene's voxels: neither a cached path nor a query of several boxes changes a result.
#include "viewer/stream/voxel_lookup.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <gtest/gtest.h>
#include <random>
#include <tuple>

#include "tests/viewer/voxel_scene.h"
#include "viewer/stream/overview_levels.h"

namespace gigabake {
namespace {

constexpr std::uint64_t seed = 20261123;
constexpr std::int64_t gappy_edge = 128;
constexpr int lods = 5;  ///< levels of the scene

/// Paints ground with gaps: one column in three has a voxel, at varying heights.
std::optional<Paint> gappy_ground(std::int64_t x, std::int64_t y, std::int64_t z) {
  if (x < 0 || y < 0 || x >= gappy_edge || y >= gappy_edge || (x * 7 + y * 13) % 3 != 0) return {};
  if (z != 20 + (x * x / 40 + y) % 60) return {};
  return Paint{{std::uint8_t(x), std::uint8_t(y), std::uint8_t(z), 255}, {0, 0}};
}

/// Returns a scene of cells of 16³ voxels with levels 0 and 1, and one overview of all cells.
VoxelScene painted() {
  VoxelScene scene(16);
  scene.add_cells(gappy_ground, {0, 0, 0}, gappy_edge);
  scene.add_overview(gappy_ground, {0, 0, 0}, gappy_edge, 2);
  return scene;
}

struct OpenGround {
  VoxelScene scene = painted();
  PagedScene paged = scene.paged();
  ShardMap map{paged, overview_levels(paged).value()};
  Pager pager{scene.pages(), {}};
  VoxelLookup lookup{map, pager};
  std::mt19937_64 random{seed};

  std::int64_t coordinate() { return std::int64_t(random() % gappy_edge); }

  /// Reads missing pages and calls question() again until all required pages are resident.
  template <class Question>
  void read_for(const Question& question) {
    for (MissingPages missing_pages;; missing_pages = {}) {
      question(missing_pages);
      if (missing_pages.missing.empty()) return;
      pager.request(missing_pages.missing);
      ASSERT_TRUE(pager.settle(std::chrono::minutes(1)));
      pager.begin_pass();
    }
  }

  /// Reads a voxel of each possible brick.
  void read_all() {
    for (int lod = 0; lod < lods; ++lod) {
      const std::int64_t bricks = gappy_edge >> (lod + 3), edge = std::int64_t(8) << lod;
      for (std::int64_t i = 0; i < bricks * bricks * bricks; ++i) {
        const Vec3i64 v{i % bricks * edge, i / bricks % bricks * edge, i / bricks / bricks * edge};
        read_for([&](MissingPages& missing_pages) {
          NodePath path;
          lookup.place(lod, v, missing_pages, path);
        });
      }
    }
  }
};

auto parts_of(const VoxelPlace& place) {
  return std::tuple(place.kind, place.page, place.brick, place.rgba, place.box.min, place.box.max);
}

TEST(VoxelLookup, AnswersAlikeWhateverWayItWentBefore) {
  OpenGround ground;
  ground.read_all();
  NodePath path;
  Vec3i64 v{0, 0, 0};
  int bricks = 0;
  for (int i = 0; i < 20000; ++i) {
    const bool is_near = ground.random() % 2 == 0;  // the next voxel shares much of the path
    for (std::int64_t& c : v) c = is_near ? (c ^ std::int64_t(ground.random() % 16)) % gappy_edge : ground.coordinate();
    const int lod = int(ground.random() % lods);
    MissingPages missing_pages;
    NodePath fresh;
    const VoxelPlace expected = ground.lookup.place(lod, v, missing_pages, fresh),
                     found = ground.lookup.place(lod, v, missing_pages, path);
    ASSERT_TRUE(missing_pages.missing.empty()) << "seed " << seed << ", " << i;
    ASSERT_EQ(parts_of(found), parts_of(expected)) << "seed " << seed << ", " << i;
    bricks += found.kind == VoxelPlace::Kind::brick ? 1 : 0;
  }
  EXPECT_GT(bricks, 1000);
}

/// Returns true if a node of the level overlaps the box; found by checking all nodes that may overlap it.
bool is_occupied(const OpenGround& ground, int lod, const kernels::VoxelBox& box) {
  const std::int64_t edge = std::int64_t(8) << lod;
  for (std::int64_t z = box.min[2] / edge * edge; z < box.max[2]; z += edge)
    for (std::int64_t y = box.min[1] / edge * edge; y < box.max[1]; y += edge)
      for (std::int64_t x = box.min[0] / edge * edge; x < box.max[0]; x += edge) {
        const Vec3i64 v{x, y, z};
        MissingPages missing_pages;
        NodePath path;
        if (ground.lookup.place(lod, v, missing_pages, path).kind != VoxelPlace::Kind::nothing) return true;
      }
  return false;
}

TEST(VoxelLookup, AnswersForEightBoxesWhatItAnswersForEach) {
  OpenGround ground;
  ground.read_all();
  int occupied = 0;
  for (int i = 0; i < 2000; ++i) {
    const int lod = int(ground.random() % lods);
    VoxelLookup::Boxes boxes;
    for (kernels::VoxelBox& box : boxes)
      for (int a = 0; a < 3; ++a) {
        box.min[a] = ground.coordinate();
        box.max[a] = std::min(gappy_edge, box.min[a] + 1 + std::int64_t(ground.random() % 40));
      }
    MissingPages missing_pages;
    const std::uint8_t found = ground.lookup.occupied(lod, boxes, missing_pages);
    ASSERT_TRUE(missing_pages.missing.empty()) << "seed " << seed << ", " << i;
    for (std::size_t b = 0; b < boxes.size(); ++b)
      ASSERT_EQ((found >> b & 1) != 0, is_occupied(ground, lod, boxes[b])) << "seed " << seed << ", " << i << ", " << b;
    occupied += std::popcount(found);
  }
  EXPECT_GT(occupied, 1000);
  EXPECT_LT(occupied, 15000);
}

}  // namespace
}  // namespace gigabake
