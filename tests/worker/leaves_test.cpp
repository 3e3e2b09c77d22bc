// Shards with leaves: voxels of coarse sources that describe all finer levels.
#include <array>
#include <gtest/gtest.h>
#include <map>
#include <set>

#include "core/base/error.h"
#include "format/scene/expanded_leaves.h"
#include "format/shard/levels/brick_walk.h"
#include "format/shard/levels/coarse_levels.h"
#include "format/shard/levels/content_hash.h"
#include "format/shard/shard_pages.h"
#include "format/shard/shard_reader.h"
#include "glb_scene.h"
#include "kernels/cpu/bake_cell.h"
#include "worker/pipeline/shard_from_volume.h"

namespace gigabake {
namespace {

constexpr std::uint32_t cell_voxels = 128;
constexpr int coarse_lod = 3;

/// A coarse slope, and a fine triangle that touches it.
struct MixedCell {
  std::vector<float> slope{0, 0, 30, 128, 0, 30, 128, 128, 90, 0, 0, 30, 128, 128, 90, 0, 128, 90},
      tip{60, 60, 40, 66, 61, 62, 61, 67, 90};
  std::vector<std::uint32_t> index{0, 1, 2, 3, 4, 5};
  kernels::MaterialView white;

  kernels::CellVolume bake(int slope_lod, std::uint32_t depth_error) const {
    std::array<kernels::PartView, 2> parts;
    parts[0].position = {slope.data(), slope.size()};
    parts[0].index = {index.data(), 6};
    parts[0].lod = slope_lod;
    parts[1].position = {tip.data(), tip.size()};
    parts[1].index = {index.data(), 3};
    for (kernels::PartView& part : parts)
      for (int i = 0; i < 3; ++i) part.scene_from_local[5 * i] = 1;
    kernels::CellParameters parameters;
    parameters.window_voxels = cell_voxels;
    parameters.depth_error = depth_error;
    return kernels::bake_cell({{parts.data(), parts.size()}, {&white, 1}, {}}, parameters, ThreadPool(1));
  }
};

Shard shard_of(int slope_lod, std::uint32_t depth_error = 0) {
  ShardHeader header;
  header.cell = "c_0_0_0";
  header.cell_voxels = cell_voxels;
  header.voxel_size_m = 1;
  header.has_directional_coverage = true;
  return shard_from_volume(MixedCell().bake(slope_lod, depth_error), header);
}

class LeavesTest : public testing::Test {
 protected:
  std::filesystem::path write(const Shard& shard) const {
    write_shard(folder.path() / "c.h5", shard, {});
    return folder.path() / "c.h5";
  }
  /// Returns the message with which the shard is refused; empty if it is read.
  std::string refusal_of(const Shard& shard) const {
    try {
      read_shard(write(shard));
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }
  /// Returns a node with leaves, other than the root.
  static std::size_t node_with_leaves(const NodeTable& nodes) {
    std::size_t n = nodes.leaf_mask.size() - 1;
    while (nodes.leaf_mask[n] == 0) --n;
    return n;
  }

  ScratchFolder folder;
};

std::set<Vec3i64> voxels_of(const NodeTable& nodes, const BrickLevel& level, int lod) {
  std::set<Vec3i64> voxels;
  for_each_voxel_of_level(
      nodes, level, lod,
      [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t*, const std::int8_t*) {
        EXPECT_TRUE(voxels.insert({x, y, z}).second) << "a voxel occurs twice";
      });
  return voxels;
}

TEST_F(LeavesTest, AreReadAsTheyWereWritten) {
  const Shard shard = shard_of(coarse_lod);
  ASSERT_EQ(shard.header.leaf_lod, std::uint32_t(coarse_lod));
  const std::filesystem::path file = write(shard);
  const Shard read = read_shard(file);
  EXPECT_EQ(read.header.leaf_lod, shard.header.leaf_lod);
  EXPECT_EQ(read.nodes.leaf_mask, shard.nodes.leaf_mask);
  EXPECT_EQ(content_hash(read), shard.header.content_hash);
  const ShardPages pages(file);
  const std::vector<NodeRow> rows = pages.nodes(0, 1u << 16);
  ASSERT_EQ(rows.size(), shard.nodes.leaf_mask.size());
  for (std::size_t n = 0; n < rows.size(); ++n) EXPECT_EQ(rows[n].leaf_mask, shard.nodes.leaf_mask[n]);
  for (int lod = 0; lod < int(shard.header.lods); ++lod) {
    const CoarseLevels coarse = ShardReader(file).coarse_levels(lod);
    for (std::size_t n = 0; n < coarse.nodes.leaf_mask.size(); ++n)
      EXPECT_EQ(coarse.nodes.leaf_mask[n], shard.nodes.leaf_mask[n]);
    EXPECT_EQ(coarse.levels.front().rgba, shard.levels[std::size_t(lod)].rgba) << lod;
  }
}

TEST_F(LeavesTest, LeaveShardsWithoutLeavesAsTheyWere) {
  const Shard shard = shard_of(0);
  EXPECT_EQ(shard.header.leaf_lod, 0u);
  EXPECT_TRUE(shard.nodes.leaf_mask.empty());
  EXPECT_TRUE(refusal_of(shard).empty());
}

TEST_F(LeavesTest, ExpandToTheCubesThatTheyDescribe) {
  const Shard shard = shard_of(coarse_lod), full = shard_of(0);
  for (int lod = 0; lod < coarse_lod; ++lod) {
    NodeTable nodes = shard.nodes;
    BrickLevel level = shard.levels[std::size_t(lod)];
    const std::vector<BrickLevel> levels(shard.levels.begin() + lod, shard.levels.end());
    expand_leaves(levels, lod, LeafShape::cube, nodes, level);
    const std::set<Vec3i64> expanded = voxels_of(nodes, level, lod),
                            stored = voxels_of(shard.nodes, shard.levels[std::size_t(lod)], lod);
    const std::vector<BrickLevel> above(levels.begin() + 1, levels.end());
    EXPECT_EQ(expanded.size(), stored.size() + voxels_of_leaves(shard.nodes, above, lod, LeafShape::cube));
    for (const Vec3i64& voxel : voxels_of(full.nodes, full.levels[std::size_t(lod)], lod))
      EXPECT_TRUE(expanded.contains(voxel)) << "a hole at level " << lod;
    // Each added voxel lies in the cube of a leaf, which is occupied at full depth.
    std::map<int, std::set<Vec3i64>> occupied;
    for (int coarser = lod + 1; coarser <= coarse_lod; ++coarser)
      occupied[coarser] = voxels_of(full.nodes, full.levels[std::size_t(coarser)], coarser);
    for (const Vec3i64& voxel : expanded) {
      if (stored.contains(voxel)) continue;
      bool is_in_cube = false;
      for (const auto& [coarser, cubes] : occupied) is_in_cube = is_in_cube || cubes.contains(voxel >> (coarser - lod));
      EXPECT_TRUE(is_in_cube);
    }
  }
}

/// Returns whether `voxels` has a voxel that is at most one voxel away along each axis.
bool has_near(const std::set<Vec3i64>& voxels, const Vec3i64& at) {
  for (int i = 0; i < 27; ++i)
    if (voxels.contains(at + Vec3i64{i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1})) return true;
  return false;
}

TEST_F(LeavesTest, ExpandToTheVoxelsThatTheirPlanesCross) {
  const Shard shard = shard_of(0, 4), full = shard_of(0);
  ASSERT_EQ(shard.header.leaf_lod, std::uint32_t(max_ended_lod));
  for (int lod = 0; lod < max_ended_lod; ++lod) {
    NodeTable nodes = shard.nodes;
    BrickLevel level = shard.levels[std::size_t(lod)];
    const std::vector<BrickLevel> levels(shard.levels.begin() + lod, shard.levels.end());
    const std::vector<BrickLevel> above(levels.begin() + 1, levels.end());
    expand_leaves(levels, lod, LeafShape::plane, nodes, level);
    const std::set<Vec3i64> expanded = voxels_of(nodes, level, lod),
                            stored = voxels_of(shard.nodes, shard.levels[std::size_t(lod)], lod),
                            all = voxels_of(full.nodes, full.levels[std::size_t(lod)], lod);
    EXPECT_LT(stored.size(), all.size() / 2) << lod;
    EXPECT_EQ(expanded.size(), stored.size() + voxels_of_leaves(shard.nodes, above, lod, LeafShape::plane)) << lod;
    EXPECT_LT(double(expanded.size()), 1.3 * double(all.size())) << lod;
    for (const Vec3i64& voxel : all) EXPECT_TRUE(has_near(expanded, voxel)) << "a hole at level " << lod;
    for (const Vec3i64& voxel : expanded) EXPECT_TRUE(has_near(all, voxel)) << "an extra voxel at level " << lod;
  }
}

TEST_F(LeavesTest, AreRefusedWhereTheHeaderAllowsNone) {
  Shard shard = shard_of(coarse_lod);
  shard.header.leaf_lod = coarse_lod - 1;
  EXPECT_NE(refusal_of(shard).find("has leaves where the shard allows none"), std::string::npos) << refusal_of(shard);
  shard.header.leaf_lod = 0;
  EXPECT_NE(refusal_of(shard).find("children are missing"), std::string::npos) << refusal_of(shard);
  shard.header.leaf_lod = shard.header.lods;
  EXPECT_NE(refusal_of(shard).find("leaf_lod is not a level"), std::string::npos) << refusal_of(shard);
}

TEST_F(LeavesTest, AreRefusedWhereTheyContradictTheTree) {
  const Shard shard = shard_of(coarse_lod);
  const std::size_t n = node_with_leaves(shard.nodes);
  Shard both = shard;
  std::size_t parent = 0;
  while (both.nodes.child_mask[parent] == 0 || both.nodes.lod[parent] > coarse_lod) ++parent;
  both.nodes.leaf_mask[parent] |= both.nodes.child_mask[parent];
  EXPECT_NE(refusal_of(both).find("is a leaf and has a child"), std::string::npos) << refusal_of(both);
  Shard empty = shard;
  empty.nodes.leaf_mask[n] = std::uint8_t(255 & ~empty.nodes.child_mask[n]);
  EXPECT_NE(refusal_of(empty).find("neither a leaf nor stored"), std::string::npos) << refusal_of(empty);
  Shard finest = shard;
  finest.nodes.leaf_mask.back() = 1;
  ASSERT_EQ(finest.nodes.lod.back(), 0);
  EXPECT_NE(refusal_of(finest).find("has leaves where the shard allows none"), std::string::npos);
}

}  // namespace
}  // namespace gigabake
