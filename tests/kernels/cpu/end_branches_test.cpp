// Branches that end within a bound: closed forms, and properties of the voxels that remain. The bound of each ended
// voxel is checked by tests/cli/bakes/depth_error_test.py, which shares no code with the program.
#include "kernels/cpu/mip/end_branches.h"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <map>
#include <vector>

#include "core/octree/morton.h"
#include "kernels/cpu/bake_cell.h"

namespace gigabake::kernels {
namespace {

constexpr std::uint32_t branch_window = 128;
constexpr std::uint32_t bound = 4;

/// Triangles of one colour each, in voxels of the window.
class Triangles {
 public:
  void add(const Vec3<float>& a, const Vec3<float>& b, const Vec3<float>& c, std::uint8_t grey = 128,
           VoxelClass voxel_class = no_class) {
    for (const Vec3<float>& corner : {a, b, c}) position_.insert(position_.end(), {corner[0], corner[1], corner[2]});
    grey_.push_back(grey);
    class_.push_back(voxel_class);
  }
  /// Adds the part of a floor from x = `low` to `high`.
  void add_strip(float low, float high, VoxelClass voxel_class) {
    const float far = branch_window, height = 20.3f;
    add({low, 0, height}, {high, 0, height}, {high, far, height}, 128, voxel_class);
    add({low, 0, height}, {high, far, height}, {low, far, height}, 128, voxel_class);
  }
  /// Adds a square z = `height` over the whole window.
  void add_floor(float height, std::uint8_t grey = 128) {
    const float far = branch_window;
    add({0, 0, height}, {far, 0, height}, {far, far, height}, grey);
    add({0, 0, height}, {far, far, height}, {0, far, height}, grey);
  }

  CellVolume bake(std::uint32_t depth_error, int threads = 1, bool classes = false) {
    std::vector<std::uint32_t> index{0, 1, 2};
    std::vector<PartView> parts;
    std::vector<MaterialView> materials(grey_.size());
    for (std::size_t t = 0; t < grey_.size(); ++t) {
      for (std::size_t c = 0; c < 3; ++c)
        materials[t].base_rgba[c] = TableStore::host().view().linear_from_srgb[grey_[t]];
      materials[t].base_rgba[3] = 65535;
      PartView part;
      part.position = {&position_[9 * t], 9};
      part.index = {index.data(), 3};
      for (const int diagonal : {0, 5, 10}) part.scene_from_local[diagonal] = 1;
      part.material = std::uint32_t(t);
      part.voxel_class = class_[t];
      parts.push_back(part);
    }
    CellParameters parameters;
    parameters.window_voxels = branch_window;
    parameters.depth_error = depth_error;
    parameters.classes = classes;
    return bake_cell({{parts.data(), parts.size()}, {materials.data(), materials.size()}, {}}, parameters,
                     ThreadPool(threads));
  }

 private:
  std::vector<float> position_;
  std::vector<std::uint8_t> grey_;
  std::vector<VoxelClass> class_;
};

std::size_t voxel_count(const Level& level) { return level.rgba.size() / 4; }

/// Returns the bricks of a level that are stored, by key: their voxels' bytes.
std::map<std::uint64_t, std::vector<std::uint8_t>> bytes_by_brick(const Level& level) {
  std::map<std::uint64_t, std::vector<std::uint8_t>> bricks;
  for (std::size_t b = 0; b < level.key.size(); ++b)
    bricks[level.key[b]] = {level.rgba.begin() + std::ptrdiff_t(4 * level.first[b]),
                            level.rgba.begin() + std::ptrdiff_t(4 * level.first[b + 1])};
  return bricks;
}

/// Returns whether the octant of level `lod` at `octant` (in octants of the level) is stored as leaves.
bool is_leaf_octant(const NodeTable& nodes, int lod, const Vec3i64& octant) {
  const std::uint64_t key = morton(std::uint32_t(octant[0]), std::uint32_t(octant[1]), std::uint32_t(octant[2]));
  for (std::size_t n = 0; n < nodes.leaf_mask.size(); ++n)
    if (nodes.lod[n] == lod && nodes.key[n] == key >> 3) return (nodes.leaf_mask[n] >> (key & 7) & 1) != 0;
  return false;
}

TEST(EndBranches, APlaneEndsAtTheCoarsestLevel) {
  for (const float height : {20.3f, 16.0f, 31.9f, 64.0f}) {
    Triangles floor;
    floor.add_floor(height);
    const CellVolume full = floor.bake(0), ended = floor.bake(bound);
    for (std::size_t lod = 0; lod < std::size_t(max_ended_lod); ++lod) EXPECT_EQ(voxel_count(ended.levels[lod]), 0u);
    for (std::size_t lod = max_ended_lod; lod < full.levels.size(); ++lod) {
      EXPECT_EQ(ended.levels[lod].rgba, full.levels[lod].rgba) << height;
      EXPECT_EQ(ended.content_hash[lod], full.content_hash[lod]);
    }
    EXPECT_EQ(ended.above.rgba, full.above.rgba);
  }
}

TEST(EndBranches, NothingEndsWithoutABound) {
  Triangles floor;
  floor.add_floor(20.3f);
  EXPECT_TRUE(floor.bake(0).nodes.leaf_mask.empty());
}

/// A step of colour along x = 64 + 2: inside voxels of level 2, and on the border of voxels of level 1.
TEST(EndBranches, AStepOfColourEndsUpToTwiceTheBound) {
  for (const std::uint8_t step : {std::uint8_t(1), std::uint8_t(bound), std::uint8_t(2 * bound + 1)}) {
    Triangles floor;
    const float far = branch_window, at = 66, height = 20.3f;
    floor.add({0, 0, height}, {at, 0, height}, {at, far, height}, 100);
    floor.add({0, 0, height}, {at, far, height}, {0, far, height}, 100);
    floor.add({at, 0, height}, {far, 0, height}, {far, far, height}, std::uint8_t(100 + step));
    floor.add({at, 0, height}, {far, far, height}, {at, far, height}, std::uint8_t(100 + step));
    const CellVolume ended = floor.bake(bound);
    EXPECT_EQ(voxel_count(ended.levels[0]), 0u) << int(step);
    EXPECT_EQ(is_leaf_octant(ended.nodes, 2, {4, 1, 1}), step <= 2 * bound) << int(step);
    EXPECT_TRUE(is_leaf_octant(ended.nodes, 2, {3, 1, 1}));
  }
}

/// A strip of another class, one voxel wide: the voxels above have the class around it.
TEST(EndBranches, AnotherClassKeepsItsVoxels) {
  Triangles floor;
  floor.add_strip(0, 61, 5);
  floor.add_strip(61, 62, 6);
  floor.add_strip(62, branch_window, 5);
  const CellVolume without = floor.bake(bound), ended = floor.bake(bound, 1, true);
  EXPECT_TRUE(is_leaf_octant(without.nodes, 2, {3, 1, 1}));
  EXPECT_FALSE(is_leaf_octant(ended.nodes, 2, {3, 1, 1}));
  EXPECT_TRUE(is_leaf_octant(ended.nodes, 2, {2, 1, 1}));
  EXPECT_TRUE(is_leaf_octant(ended.nodes, 2, {4, 1, 1}));
  EXPECT_EQ(std::ranges::count(ended.levels[0].voxel_class, VoxelClass(6)), branch_window);
}

/// The border of a surface: columns of which half is covered must not become covered leaves.
TEST(EndBranches, BordersAcrossLeavesStay) {
  Triangles half;
  half.add({0, 0, 20.3f}, {67, 0, 20.3f}, {67, 128, 20.3f});
  half.add({0, 0, 20.3f}, {67, 128, 20.3f}, {0, 128, 20.3f});
  const CellVolume ended = half.bake(bound);
  EXPECT_FALSE(is_leaf_octant(ended.nodes, 2, {4, 1, 1}));
  EXPECT_TRUE(is_leaf_octant(ended.nodes, 2, {3, 1, 1}));
  std::int64_t max_x = 0;
  for (const std::uint64_t key : ended.levels[0].key) max_x = std::max(max_x, Vec3i64(demorton(key))[0]);
  EXPECT_EQ(max_x, 66 / 8);
}

/// Floors in all octants, and a spike in one. Around an octant of several levels, the octants along each face, edge and
/// corner are of level 2.
TEST(EndBranches, ASpikeRefinesOnlyItsOctants) {
  Triangles floors;
  for (const float height : {6.2f, 23.7f, 40.5f, 62.9f, 70.1f, 88.4f, 105.0f, 120.6f}) floors.add_floor(height);
  const CellVolume flat = floors.bake(bound);
  floors.add({41, 42, 39}, {42, 42, 39}, {41.5f, 42.5f, 46}, 250);
  const CellVolume full = floors.bake(0), ended = floors.bake(bound);
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z) {
        EXPECT_TRUE(is_leaf_octant(flat.nodes, 2, {x, y, z}));
        EXPECT_EQ(is_leaf_octant(ended.nodes, 2, {x, y, z}), x != 2 || y != 2 || z != 2) << x << y << z;
      }
  const auto all = bytes_by_brick(full.levels[0]);
  const auto kept = bytes_by_brick(ended.levels[0]);
  EXPECT_FALSE(kept.empty());
  EXPECT_LT(kept.size(), 8u);
  for (const auto& [key, bytes] : kept) {
    EXPECT_EQ(bytes, all.at(key));
    for (int a = 0; a < 3; ++a) EXPECT_EQ(Vec3i64(demorton(key))[std::size_t(a)] / 2, 2);
  }
  EXPECT_TRUE(kept.contains(morton(5, 5, 5)));
}

TEST(EndBranches, SlopesThroughCornersEndEquallyOnAllThreads) {
  Triangles slopes;
  slopes.add({0, 0, 0}, {128, 0, 128}, {0, 128, 0});      // z = x
  slopes.add({128, 0, 0}, {0, 128, 0}, {0, 0, 128}, 60);  // x + y + z = 128
  slopes.add({0, 0, 128}, {128, 128, 128}, {64, 64, 0});  // x = y
  const CellVolume full = slopes.bake(0), one = slopes.bake(bound), two = slopes.bake(bound, 2);
  EXPECT_EQ(one.content_hash, two.content_hash);
  EXPECT_EQ(one.nodes.leaf_mask, two.nodes.leaf_mask);
  EXPECT_LT(voxel_count(one.levels[0]), voxel_count(full.levels[0]) / 2);
  for (std::size_t lod = 0; lod < full.levels.size(); ++lod) {
    const auto all = bytes_by_brick(full.levels[lod]);
    for (const auto& [key, bytes] : bytes_by_brick(one.levels[lod])) EXPECT_EQ(bytes, all.at(key));
  }
}

}  // namespace
}  // namespace gigabake::kernels
