#include "kernels/marching/surface_blend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <vector>

#include "kernels/pool/pack_brick.h"

namespace gigabake::kernels {
namespace {

const std::uint8_t whole_sheet = pack_plane({0, max_coherence});

struct Slot {
  CastVoxel voxel[slot_voxels] = {};
  CastVoxel& at(int x, int y, int z) { return voxel[x + slot_edge * (y + slot_edge * z)]; }
};

/// A brick in the format of the pools. It has the voxels of a slot that have coverage along at least one axis.
class Brick {
 public:
  explicit Brick(const Slot& slot) {
    SlotVoxels voxels;
    for (int at = 0; at < slot_voxels; ++at) {
      const CastVoxel& voxel = slot.voxel[at];
      if ((voxel.c[3] | voxel.c[4] | voxel.c[5]) == 0) continue;
      std::uint16_t& row = voxels.row[at / (slot_edge * slot_edge)][at / slot_edge % slot_edge];
      row = std::uint16_t(row | 1u << at % slot_edge);
      voxels.voxel[at] = pack_voxel(voxel);
    }
    pack_brick(voxels, brick_);
  }
  BrickView view() const { return {brick_.head.layers, 0, brick_.parts.data()}; }

 private:
  CastBrick brick_;
};

constexpr Vec3d down{0, 0, -1};

CastVoxel opaque_voxel() { return {{32768, 32768, 32768, 65535, 65535, 65535}, {0, 0, 127}, 0}; }

struct RandomPoints {
  std::mt19937_64 random{20261123};
  std::uniform_real_distribution<float> unit{0, 1};

  CastPoint next() {
    CastPoint p;
    for (int a = 0; a < 3; ++a) {
      p.base[a] = int(random() % 8);
      p.between[a] = unit(random);
    }
    return p;
  }
};

struct CastField {
  CastSample residual;
  SurfaceBlend blend;
};

CastField field_at(const CastCorners& corners, bool is_wanted, const Vec3d& direction) {
  const NeighbourhoodSurface neighbourhood = classify_neighbourhood(corners, 1, is_wanted ? 1 : 0, true, 0);
  return {volumetric_residual(corners, neighbourhood, direction, false).sample, neighbourhood.blend};
}

TEST(CastField, IsInterpolatedAsEverWhereThereIsNoSheet) {
  RandomPoints points;
  const auto slot = std::make_unique<Slot>();
  for (CastVoxel& v : slot->voxel) {
    for (std::uint16_t& c : v.c) c = std::uint16_t(points.random());
    for (int a = 3; a < 6; ++a) v.c[a] = std::uint16_t(257 * (v.c[a] / 257));
  }
  const Brick brick(*slot);
  for (int i = 0; i < 1000; ++i) {
    const CastPoint p = points.next();
    const CastField field = field_at(corners_of(brick.view(), p), true, down);
    const CastSample plain = interpolate(corners_of(brick.view(), p));
    ASSERT_EQ(std::memcmp(&field.residual, &plain, sizeof plain), 0);
    ASSERT_EQ(field.blend.signed_distance(), 0);
  }
}

/// Returns a slot whose voxels all lie on one plane through its middle, as exactly as bytes can store it.
std::unique_ptr<Slot> slot_of_plane(const std::int8_t normal[2]) {
  auto slot = std::make_unique<Slot>();
  const OctahedronPoint n = octahedron_point(normal);
  for (int z = 0; z < slot_edge; ++z)
    for (int y = 0; y < slot_edge; ++y)
      for (int x = 0; x < slot_edge; ++x) {
        const double away = -2 * (n.c[0] * (x - 4) + n.c[1] * (y - 4) + n.c[2] * (z - 4)) / 127.0;
        if (std::abs(away) > 1) continue;
        CastVoxel v = opaque_voxel();
        for (int a = 0; a < 3; ++a) v.normal[a] = std::int8_t(n.c[a]);
        v.plane = pack_plane({int(std::lround(away * max_offset)), max_coherence});
        slot->at(x, y, z) = v;
      }
  return slot;
}

TEST(SurfaceBlend, IsWhereThePlaneOfItsVoxelsIs) {
  RandomPoints points;
  for (int i = 0; i < 200; ++i) {
    const std::int8_t normal[2] = {std::int8_t(int(points.random() % 255) - 127),
                                   std::int8_t(int(points.random() % 255) - 127)};
    const OctahedronPoint n = octahedron_point(normal);
    const Brick brick(*slot_of_plane(normal));
    for (int k = 0; k < 200; ++k) {
      const CastPoint p = points.next();
      const SurfaceBlend blend = field_at(corners_of(brick.view(), p), true, down).blend;
      if (blend.weight == 0) continue;
      double above = 0;
      for (int a = 0; a < 3; ++a) above += n.c[a] / 127.0 * (p.base[a] + double(p.between[a]) - 4);
      ASSERT_NEAR(blend.signed_distance(), above, 0.25 / max_offset + 0.5 / 127 + 1e-5)
          << "half a unit of offset and place";
    }
  }
}

/// 2026-11-26: planes of triangles that are wound differently cancelled each other.
TEST(SurfaceBlend, IsTheSameForAnyWinding) {
  RandomPoints points;
  std::size_t compared = 0;
  for (int i = 0; i < 200; ++i) {
    const std::int8_t normal[2] = {std::int8_t(int(points.random() % 255) - 127),
                                   std::int8_t(int(points.random() % 255) - 127)};
    const OctahedronPoint n = octahedron_point(normal);
    const ByteVector side = byte_vector(n.c[0], n.c[1], n.c[2]);
    const auto slot = slot_of_plane(normal);
    const Brick plain(*slot);
    for (CastVoxel& v : slot->voxel) {
      if (v.plane == 0 || points.random() % 2 == 0) continue;
      for (std::int8_t& c : v.normal) c = std::int8_t(-c);
      v.plane = pack_plane({-unpack_plane(v.plane).offset, max_coherence});
    }
    const Brick mixed(*slot);
    for (int k = 0; k < 100; ++k) {
      const CastPoint p = points.next();
      const BlendedPlanes a = blend_planes(corners_of(plain.view(), p), side);
      const BlendedPlanes b = blend_planes(corners_of(mixed.view(), p), side);
      ASSERT_EQ(std::memcmp(&a.blend, &b.blend, sizeof a.blend), 0);
      ASSERT_EQ(a.is_flat, b.is_flat);
      ASSERT_EQ(residual_sample(corners_of(mixed.view(), p), b.blend).mean_coverage(), 0);
      compared += a.blend.weight > 0;
    }
  }
  EXPECT_GT(compared, 5000u);
}

// 2026-11-23: coarse levels let light through where a surface passes from one layer of voxels to the next.
TEST(SurfaceBlend, IsOpaqueWhereverARayMeetsIt) {
  RandomPoints points;
  for (int i = 0; i < 200; ++i) {
    const std::int8_t normal[2] = {std::int8_t(int(points.random() % 255) - 127),
                                   std::int8_t(int(points.random() % 255) - 127)};
    const Brick brick(*slot_of_plane(normal));
    for (int k = 0; k < 500; ++k) {
      const CastPoint p = points.next();
      const SurfaceBlend blend = field_at(corners_of(brick.view(), p), true, down).blend;
      if (blend.weight == 0 || std::abs(blend.signed_distance()) > 0.02f) continue;
      ASSERT_GE(surface_opacity(brick.view(), p, blend).opacity, 0.99f);
    }
  }
}

TEST(CastField, HasNoSheetInABrickThatStandsForFinerOnes) {
  RandomPoints points;
  const std::int8_t up[2] = {0, 0};
  const Brick brick(*slot_of_plane(up));
  for (int i = 0; i < 1000; ++i) {
    const CastPoint p = points.next();
    const CastField field = field_at(corners_of(brick.view(), p), false, down);
    ASSERT_EQ(field.blend.signed_distance(), 0);
    ASSERT_EQ(field.residual.mean_coverage(), interpolate(corners_of(brick.view(), p)).mean_coverage());
  }
}

TEST(SurfaceBlend, HasTheLooseAloneInWhatIsLoose) {
  const auto slot = std::make_unique<Slot>();
  for (CastVoxel& v : slot->voxel) {
    v = opaque_voxel();
    v.plane = whole_sheet;
  }
  const CastPoint middle{{3, 3, 3}, {0.5f, 0.5f, 0.5f}};
  const auto residual = [&] {
    const Brick brick(*slot);
    return field_at(corners_of(brick.view(), middle), true, down).residual.mean_coverage();
  };
  EXPECT_EQ(residual(), 0) << "planes describe all of the coverage";
  slot->at(3, 3, 3).plane = 0;
  EXPECT_NEAR(residual(), 1.0f / 8, 1e-6f);
  slot->at(4, 3, 3).plane = pack_plane({0, 2});
  EXPECT_NEAR(residual(), 2.0f / 8, 1e-6f) << "a voxel that its plane describes only in part";
}

TEST(Disagreement, IsOfPlanesThatAreFartherThanThirtyDegreesFromTheSheet) {
  const ByteVector up = byte_vector(0, 0, 127);
  const auto sheet_at = [](double degrees) {
    const double slope = degrees * 3.14159265358979 / 180;
    return normal_of(SurfaceBlend{1, {float(std::sin(slope)), 0, float(std::cos(slope))}, 0});
  };
  EXPECT_EQ(disagreement(up, sheet_at(0)), 0);
  EXPECT_EQ(disagreement(up, sheet_at(29)), 0);
  EXPECT_NEAR(disagreement(up, sheet_at(37.76)), 0.5f, 0.01f);
  EXPECT_EQ(disagreement(up, sheet_at(46)), 1);
  EXPECT_EQ(disagreement(up, sheet_at(134)), 1);
  EXPECT_EQ(disagreement(up, sheet_at(151)), 0) << "the other side of the same plane";
  EXPECT_EQ(disagreement(up, sheet_at(180)), 0);
}

// If two surfaces intersect, the blended surface may not exist. The coverages of the two surfaces are then composited.
TEST(CastField, CountsSheetsByTheirCoverageWhereTheyDisagree) {
  const auto slot = std::make_unique<Slot>();
  for (int z = 0; z < slot_edge; ++z)
    for (int y = 0; y < slot_edge; ++y)
      for (int x = 0; x < slot_edge; ++x) {
        CastVoxel v = opaque_voxel();
        v.plane = whole_sheet;
        if (x < 4) std::swap(v.normal[0], v.normal[2]);
        slot->at(x, y, z) = v;
      }
  const Brick brick(*slot);
  const CastSample edge = field_at(corners_of(brick.view(), {{3, 3, 3}, {0.5f, 0.5f, 0.5f}}), true, down).residual;
  EXPECT_NEAR(edge.c[3], 0.5f, 1e-3f);
  EXPECT_NEAR(edge.c[4], 0, 1e-3f) << "neither covers a view along y";
  EXPECT_NEAR(edge.c[5], 0.5f, 1e-3f);
  EXPECT_EQ(field_at(corners_of(brick.view(), {{1, 3, 3}, {0.5f, 0.5f, 0.5f}}), true, down).residual.mean_coverage(),
            0);
}

TEST(PartInPair, IsHowMuchOfAColumnsSheetLiesInTwoVoxels) {
  EXPECT_EQ(part_in_pair(0.5f, 0.5f), 1);
  EXPECT_EQ(part_in_pair(0, 0.5f), 1);
  EXPECT_EQ(part_in_pair(-0.5f, 0.5f), 0.5f);
  EXPECT_EQ(part_in_pair(1.5f, 0.125f), 0.5f);
  EXPECT_EQ(part_in_pair(2.5f, 0.5f), 0);
}

/// Returns voxels of surfaces whose normals differ from one direction by up to `spread` bytes per component. If
/// `is_mixed`, some voxels have a second surface or residual coverage.
Slot random_sheets(std::mt19937_64& random, int spread, bool is_mixed) {
  const auto byte = [&](int maximum) { return int(random() % std::uint64_t(2 * maximum + 1)) - maximum; };
  const int to[2] = {byte(60), byte(60)};
  Slot slot;
  for (CastVoxel& voxel : slot.voxel) {
    if (random() % 2 == 0) continue;
    const auto normal = [&](int a) { return std::int8_t(to[a] + byte(spread)); };
    const int x = normal(0), y = normal(1), z = std::max(0, 127 - std::abs(x) - std::abs(y));
    const int coherence = is_mixed && random() % 8 == 0 ? 1 : max_coherence;
    for (int k = 0; k < 3; ++k) voxel.c[3 + k] = std::uint16_t(257 * (1 + random() % 255));
    voxel = {{9, 9, 9, voxel.c[3], voxel.c[4], voxel.c[5]},
             {std::int8_t(x), std::int8_t(y < 0 ? std::abs(x) + z - 127 : 127 - std::abs(x) - z), std::int8_t(z)},
             pack_plane({byte(7), coherence})};
  }
  return slot;
}

TEST(Sheet, IsAllThereIsWhereItIsCalledFlat) {
  std::mt19937_64 random(20261124);
  int flat = 0, others = 0;
  for (int i = 0; i < 400; ++i) {
    SCOPED_TRACE(::testing::Message() << "seed 20261124, brick " << i);
    const Brick brick(random_sheets(random, i % 40, i % 3 == 0));
    RandomPoints points;
    for (int n = 0; n < 50; ++n) {
      const CastCorners corners = corners_of(brick.view(), points.next());
      const NeighbourhoodSurface neighbourhood = classify_neighbourhood(corners, 1, 1, false, 0);
      if (neighbourhood.kind != PointKind::surface) continue;
      const CastSample residual = residual_sample(corners, neighbourhood.blend);
      ++(neighbourhood.is_flat ? flat : others);
      for (int k = 0; neighbourhood.is_flat && k < cast_channels; ++k) ASSERT_EQ(residual.c[k], 0);
    }
  }
  EXPECT_GT(flat, 2000);
  EXPECT_GT(others, 2000);
}

}  // namespace
}  // namespace gigabake::kernels
