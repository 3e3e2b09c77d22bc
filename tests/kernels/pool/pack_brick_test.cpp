#include "kernels/pool/pack_brick.h"

#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "kernels/marching/cast.h"

namespace gigabake::kernels {
namespace {

bool is_there(const SlotVoxels& slot, int x, int y, int z) { return (slot.row[z][y] >> x & 1) != 0; }

std::uint32_t content_of(int x, int y, int z) { return std::uint32_t(x + slot_edge * (y + slot_edge * z)); }

/// Returns voxels in random boxes, each a slice, a bar or a corner. Each box is filled with a random density; more
/// boxes give a denser slot.
SlotVoxels random_slot(std::mt19937_64& random) {
  SlotVoxels slot;
  for (auto boxes = random() % 4; boxes > 0; --boxes) {
    int from[3], to[3];
    for (int a = 0; a < 3; ++a) {
      from[a] = int(random() % slot_edge);
      to[a] = from[a] + int(random() % std::uint64_t(slot_edge - from[a]));
    }
    const std::uint64_t one_in = 1 + random() % 6;
    for (int z = from[2]; z <= to[2]; ++z)
      for (int y = from[1]; y <= to[1]; ++y)
        for (int x = from[0]; x <= to[0]; ++x)
          if (random() % one_in == 0) slot.row[z][y] = std::uint16_t(slot.row[z][y] | 1u << x);
  }
  for (int z = 0; z < slot_edge; ++z)
    for (int y = 0; y < slot_edge; ++y)
      for (int x = 0; x < slot_edge; ++x) slot.voxel[content_of(x, y, z)] = {{content_of(x, y, z), 0, 0}};
  return slot;
}

/// Returns the number of voxels plus the number of layers that have voxels.
std::size_t count_parts(const SlotVoxels& slot) {
  std::size_t parts = 0;
  for (const auto& layer : slot.row) {
    std::size_t voxels = 0;
    for (const std::uint16_t row : layer) voxels += std::size_t(std::popcount(row));
    parts += voxels + (voxels > 0 ? 1 : 0);
  }
  return parts;
}

/// Returns true if the interpolation at any point of the cube [from, from + size)³ reads a voxel that exists.
bool has_field(const SlotVoxels& slot, const int from[3], int size) {
  for (int z = from[2]; z <= from[2] + size; ++z)
    for (int y = from[1]; y <= from[1] + size; ++y)
      for (int x = from[0]; x <= from[0] + size; ++x)
        if (is_there(slot, x, y, z)) return true;
  return false;
}

BrickView view_of(const CastBrick& brick) { return {brick.head.layers, 0, brick.parts.data()}; }

void expect_places(const SlotVoxels& slot, const CastBrick& brick, const CastPoint& point) {
  const CastCorners corners = corners_of(view_of(brick), point);
  for (int corner = 0; corner < 8; ++corner) {
    const LayerWindow layer = corner < 4 ? corners.low : corners.high;
    const int k = (corner & 1) + slot_edge * (corner >> 1 & 1);
    const int at[3] = {point.base[0] + (corner & 1), point.base[1] + (corner >> 1 & 1), point.base[2] + (corner >> 2)};
    ASSERT_EQ(layer.has(k), is_there(slot, at[0], at[1], at[2])) << at[0] << " " << at[1] << " " << at[2];
    if (!layer.has(k)) continue;
    ASSERT_EQ(corners.packed(corner).word[0], content_of(at[0], at[1], at[2]));
  }
}

CastLine line_along(int axis, bool is_up) {
  CastLine line;
  for (int a = 0; a < 3; ++a) set_direction(line, a, a == axis ? (is_up ? 1 : -1) : 0);
  return line;
}

/// Checks the distance along each axis from a point where the field is zero to the exit of the empty part around it.
/// The part is half of the brick if that is empty, else a quarter, else none. The distance is never too long, and too
/// short only by the rounding error.
void expect_empty_part(const SlotVoxels& slot, const CastBrick& brick, const CastPoint& point) {
  int edge = 0, from[3] = {0, 0, 0};
  for (const int tried : {2, 4}) {
    int corner[3];
    for (int a = 0; a < 3; ++a) corner[a] = point.base[a] / tried * tried;
    if (has_field(slot, corner, tried)) continue;
    edge = tried;
    for (int a = 0; a < 3; ++a) from[a] = corner[a];
  }
  Vec3<std::uint32_t> u;
  for (int a = 0; a < 3; ++a) u[a] = std::uint32_t(point.base[a]) * fixed_one + fixed_one / 2;
  for (int a = 0; a < 3; ++a)
    for (const bool is_up : {false, true}) {
      const float way = exit_distance_empty_part(brick.head.blocks, line_along(a, is_up), u) / float(fixed_one);
      const float middle = float(point.base[a]) + 0.5f, side = float(from[a] + (is_up ? edge : 0));
      if (edge == 0)
        ASSERT_EQ(way, 0);
      else
        ASSERT_NEAR(way, std::fabs(side - middle), 8.0f / float(fixed_one)) << "axis " << a;
      ASSERT_LE(way, std::fabs(side - middle));
    }
}

TEST(PackBrick, SaysWhereTheFieldIsZeroAndWhereVoxelsStand) {
  constexpr std::uint64_t seed = 20261124;
  std::mt19937_64 random(seed);
  for (int i = 0; i < 200; ++i) {
    const SlotVoxels slot = random_slot(random);
    CastBrick brick;
    pack_brick(slot, brick);
    ASSERT_EQ(brick.parts.size(), count_parts(slot)) << "seed " << seed << ", brick " << i;
    for (int at = 0; at < brick_edge * brick_edge * brick_edge; ++at) {
      const CastPoint point{{at % 8, at / 8 % 8, at / 64}, {0.5f, 0.5f, 0.5f}};
      const int block[3] = {point.base[0] & ~1, point.base[1] & ~1, point.base[2] & ~1};
      SCOPED_TRACE(::testing::Message() << "seed " << seed << ", brick " << i << ", point " << at);
      const bool has_block = (brick.head.blocks >> block_of(block[0], block[1], block[2]) & 1) != 0;
      ASSERT_EQ(has_block, has_field(slot, block, 2));
      const bool is_empty = is_zero(brick.head.blocks, view_of(brick), point);
      ASSERT_EQ(is_empty, !has_field(slot, point.base.v, 1));
      if (is_empty) expect_empty_part(slot, brick, point);
      expect_places(slot, brick, point);
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
}

}  // namespace
}  // namespace gigabake::kernels
