#include "kernels/marching/tap_vectors.h"

#include <cstring>
#include <gtest/gtest.h>
#include <random>

#include "kernels/marching/seen_side.h"
#include "kernels/marching/surface_blend.h"
#include "kernels/pool/pack_brick.h"
#include "tests/random_seed.h"

namespace gigabake::kernels {
namespace {

/// Bricks of random voxels. Few of `normals` differ, so that many voxels are flat or opposite.
struct RandomBricks {
  std::mt19937_64 random;

  std::int8_t normal_part() { return std::int8_t(int(random() % 255) - 127); }

  CastBrick next() {
    std::int8_t normals[2][2];
    for (auto& normal : normals)
      for (std::int8_t& part : normal) part = normal_part();
    const std::uint64_t kept = 1 + random() % 8, planes = random() % 3;
    SlotVoxels slot;
    for (int at = 0; at < slot_voxels; ++at) {
      if (random() % 8 >= kept) continue;
      CastVoxel voxel;
      for (int k = 0; k < 3; ++k) voxel.c[k] = std::uint16_t(random());
      for (int k = 3; k < 6; ++k) voxel.c[k] = std::uint16_t(257 * (random() % 256));
      const OctahedronPoint n = octahedron_point(normals[random() % 8 == 0 ? 1 : 0]);
      const int turn = random() % 8 == 0 ? -1 : 1;
      if (random() % 16 != 0)
        for (int a = 0; a < 3; ++a) voxel.normal[a] = std::int8_t(turn * n.c[a]);
      const int coherence = planes == 0 ? max_coherence : int(random() % (max_coherence + 1));
      voxel.plane = pack_plane({int(random() % 15) - max_offset, coherence});
      if (planes == 1 && random() % 8 == 0) voxel.plane = clear_plane;
      std::uint16_t& row = slot.row[at / (slot_edge * slot_edge)][at / slot_edge % slot_edge];
      row = std::uint16_t(row | 1u << at % slot_edge);
      slot.voxel[at] = pack_voxel(voxel);
    }
    CastBrick brick;
    pack_brick(slot, brick);
    return brick;
  }

  CastPoint point() {
    std::uniform_real_distribution<float> unit{0, 1};
    CastPoint p;
    for (int a = 0; a < 3; ++a) {
      p.base[a] = int(random() % 8);
      p.between[a] = random() % 8 == 0 ? 0 : unit(random);
    }
    return p;
  }

  ByteVector side() {
    if (random() % 3 == 0) return 0;
    const std::int8_t normal[2] = {normal_part(), normal_part()};
    const OctahedronPoint n = octahedron_point(normal);
    return byte_vector(n.c[0], n.c[1], n.c[2]);
  }
};

/// Adds the channels of the voxels one by one, weighted by weight(corner, voxel).
template <class Weight>
CastSample sum_voxels(const CastCorners& corners, const Weight& weight) {
  CastSample sum;
  for (int c = 0; c < 8; ++c) {
    if ((corners.there() >> c & 1) == 0) continue;
    const CastVoxel voxel = corners.stored(c);
    for (int k = 0; k < cast_channels; ++k) sum.c[k] += weight(c, voxel) * voxel.c[k];
  }
  return sum;
}

bool same_bits(const CastSample& a, const CastSample& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// Compares the side of the surface and its light.
void expect_same_side(RandomBricks& bricks, const CastCorners& corners) {
  const SurfaceSide loop = surface_side_by_voxel(corners), lanes = surface_side(corners);
  ASSERT_EQ(loop.normal, lanes.normal);
  ASSERT_EQ(loop.signed_distance, lanes.signed_distance);
  ASSERT_EQ(loop.first, lanes.first);
  ASSERT_EQ(loop.is_mixed, lanes.is_mixed);
  std::uniform_real_distribution<float> unit{-1, 1};
  const CastLight light{{0.6f, 0, 0.8f}, {2, 1, unit(bricks.random)}, {0.1f, 0.2f, 0.3f}, {0.2f, 0.1f, 0}};
  const Vec3<float> to_eye{unit(bricks.random), unit(bricks.random), unit(bricks.random)};
  SideLight of_loop, of_lanes;
  for (const bool of_surface : {true, false}) {
    add_light_by_voxel(corners, light, to_eye, of_surface, of_loop);
    add_light(corners, light, to_eye, of_surface, of_lanes);
  }
  ASSERT_EQ(std::memcmp(&of_loop, &of_lanes, sizeof of_loop), 0);
}

/// Returns translucent_surface_at() from the voxels one by one.
TranslucentSurface translucent_voxels(const CastCorners& corners, const Vec3d& direction) {
  float there = 0, hidden = 0, across = 0;
  for (int c = 0; c < 8; ++c) {
    if ((corners.there() >> c & 1) == 0) continue;
    const CastVoxel voxel = corners.stored(c);
    if (voxel.c[3] == 0 && voxel.c[4] == 0 && voxel.c[5] == 0) continue;
    there += corners.weight(c);
    hidden += corners.weight(c) * voxel.c[3];
    across += corners.weight(c) * (voxel.plane == 0 ? 1 : length_along(direction, vector_of_normal(voxel)));
  }
  return there > 0 ? TranslucentSurface{hidden / (there * 65535), across / there} : TranslucentSurface{};
}

TEST(TapVectors, GiveTheBitsOfLoopsOverVoxels) {
  const test::RandomSeed seed;
  RandomBricks bricks{std::mt19937_64(seed)};
  std::size_t flat = 0, mixed = 0, empty = 0;
  for (int i = 0; i < 400; ++i) {
    const CastBrick brick = bricks.next();
    for (int k = 0; k < 100; ++k) {
      const CastCorners corners = corners_of({brick.head.layers, 0, brick.parts.data()}, bricks.point());
      const ByteVector side = bricks.side();
      const BlendedPlanes loop = blend_planes_by_voxel(corners, side), lanes = blend_planes(corners, side);
      ASSERT_EQ(std::memcmp(&loop.blend, &lanes.blend, sizeof loop.blend), 0) << "corners " << corners.there();
      ASSERT_EQ(loop.bits, lanes.bits);
      ASSERT_EQ(loop.is_flat, lanes.is_flat);
      ASSERT_EQ(loop.is_mixed, lanes.is_mixed);
      flat += loop.is_flat && loop.bits != 0;
      mixed += loop.is_mixed;
      empty += corners.there() == 0;
      expect_same_side(bricks, corners);
      const Vec3d direction{0.48, -0.6, 0.64};
      const TranslucentSurface one_by_one = translucent_voxels(corners, direction),
                               together = translucent_surface_at(corners, direction[0], direction[1], direction[2]);
      ASSERT_EQ(one_by_one.density, together.density);
      ASSERT_EQ(one_by_one.across, together.across);
      ASSERT_TRUE(same_bits(interpolate(corners), sum_voxels(corners, [&](int c, const CastVoxel&) {
                              return corners.weight(c) * (1.0f / 65535);
                            })));
      ASSERT_TRUE(same_bits(surface_sample(corners), sum_voxels(corners, [&](int c, const CastVoxel& voxel) {
                              return corners.weight(c) * blend_weight(voxel) * (1.0f / 65535);
                            })));
    }
  }
  EXPECT_GT(flat, 100u);
  EXPECT_GT(mixed, 100u);
  EXPECT_GT(empty, 10u);
}

}  // namespace
}  // namespace gigabake::kernels
