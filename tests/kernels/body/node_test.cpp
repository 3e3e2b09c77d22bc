#include "kernels/body/prune/node.h"

#include <gtest/gtest.h>

#include "kernels/body/mip/level_voxel.h"
#include "kernels/body/voxelize/window.h"

namespace gigabake::kernels {
namespace {

TEST(NodeChildren, StartAtTheLowestAndAreNamedByTheirOctants) {
  NodeChildren children;
  EXPECT_EQ(children.first, no_child);
  EXPECT_EQ(children.mask, 0);
  children.add(17, 8 * 5 + 2);
  children.add(18, 8 * 5 + 7);
  EXPECT_EQ(children.first, 17u);
  EXPECT_EQ(children.mask, 0x84);
}

TEST(NodeTable, TakesNodesUpTo2To32Less2) {
  EXPECT_NO_THROW(check_node_count(0xfffffffeu));
  EXPECT_THROW(check_node_count(0xffffffffu), std::length_error);
  EXPECT_THROW(check_node_count(std::uint64_t(1) << 40), std::length_error);
}

TEST(FullBrick, HasAll512Voxels) {
  const std::uint64_t full[2] = {100, 612}, other[2] = {100, 611};
  EXPECT_TRUE(is_full(full));
  EXPECT_FALSE(is_full(other));
}

TEST(CellWindow, ComesFromTheParameters) {
  CellParameters p;
  p.window_voxels = 8192;
  p.window_min[1] = -64;
  p.surface = SurfaceRule::thin;
  const CellWindow maximum = window_of(p);
  EXPECT_EQ(maximum.edge, 8192 * 256);
  EXPECT_EQ(maximum.bricks, 1024);
  EXPECT_EQ(maximum.levels + 1, max_levels);
  EXPECT_EQ(key_bits(maximum), 30);
  EXPECT_EQ(maximum.min[1], -64);
  EXPECT_EQ(maximum.rule, SurfaceRule::thin);
  p.window_voxels = 8;
  EXPECT_EQ(window_of(p).levels, 0);
}

TEST(HashOfVoxel, IsOfItsLowestCornerInVoxelsOfTheFinestLevel) {
  const Vec3i64 min{-800, 16, 1024};
  const std::uint8_t directional_coverage[directional_coverage_bytes] = {1, 2, 3, 4};
  const BrickCoordinate brick{5, 0, 2};
  const int voxel = 3 + 8 * 7 + 64 * 4;
  const Hash128 plain = hash_of_voxel(min, 2, brick, voxel, 0x80ff01, 77, nullptr);
  EXPECT_EQ(plain, hash_voxel(2, -800 + 4 * 43, 16 + 4 * 7, 1024 + 4 * 20, 0x80ff01, 77));
  const Hash128 faced = hash_of_voxel(min, 2, brick, voxel, 0x80ff01, 77, directional_coverage);
  EXPECT_EQ(faced, hash_voxel(2, -800 + 4 * 43, 16 + 4 * 7, 1024 + 4 * 20, 0x80ff01, 77, 0x04030201));
}

TEST(Voxel, PacksAndUnpacksItsBytes) {
  const Voxel v{{1, 2, 3, 255}, {-128, 127}};
  const Voxel again = unpack_voxel(pack_rgba(v.rgba), pack_normal(v.normal));
  EXPECT_EQ(pack_rgba(v.rgba), 0xff030201u);
  EXPECT_EQ(pack_normal(v.normal), 0x7f80);
  for (int c = 0; c < 4; ++c) EXPECT_EQ(again.rgba[c], v.rgba[c]);
  for (int c = 0; c < 2; ++c) EXPECT_EQ(again.normal[c], v.normal[c]);
}

}  // namespace
}  // namespace gigabake::kernels
