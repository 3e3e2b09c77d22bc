/// Tests the reference without another clipper: by the points of pieces, by sums of areas and by closed forms.
#include "bench/exact/exact_clip.h"

#include <cmath>
#include <gtest/gtest.h>

#include "core/base/rules.h"
#include "print.h"
#include "triangle_families.h"

namespace gigabake::reference {
namespace {

/// Returns a window that contains the whole closed triangle.
Window around(const Triangle& t) {
  const LatticeVertex low = min_by_axis(min_by_axis(t[0], t[1]), t[2]),
                      high = max_by_axis(max_by_axis(t[0], t[1]), t[2]);
  return {(low >> 8) - Voxel::all(1), (std::ranges::max(high - low) >> 8) + 4};
}

bool inside(const RationalPoint& p, const Voxel& voxel) {
  for (int r = 0; r < 3; ++r) {
    const mpq_class low(long(voxel[r] * 256));
    if (p[r] < low || p[r] > low + 256) return false;
  }
  return true;
}

/// Returns true if p is in the closed triangle. Then p splits it into three triangles whose area vectors add up.
bool inside(const RationalPoint& p, const Triangle& t) {
  Polygon corner(3);
  for (int k = 0; k < 3; ++k)
    for (int r = 0; r < 3; ++r) corner[k][r] = mpq_class(long(t[k][r]));
  const RationalPoint whole = area_vector(corner);
  RationalPoint sum;
  for (int k = 0; k < 3; ++k) {
    const RationalPoint part = area_vector({p, corner[k], corner[(k + 1) % 3]});
    mpq_class along;
    for (int r = 0; r < 3; ++r) {
      along += part[r] * whole[r];
      sum[r] += part[r];
    }
    if (along < 0) return false;
  }
  const mpq_class in_plane =
      whole[0] * (p[0] - corner[0][0]) + whole[1] * (p[1] - corner[0][1]) + whole[2] * (p[2] - corner[0][2]);
  return in_plane == 0 && sum == whole;
}

class ExactClip : public testing::TestWithParam<Family> {};

TEST_P(ExactClip, EveryPieceIsMadeOfPointsOfTheTriangleAndTheVoxel) {
  Rng rng(11);
  for (int i = 0; i < 100; ++i) {
    const Triangle t = random_triangle(GetParam(), {{-4, -4, -4}, 8}, rng);
    for (const Piece& piece : pieces_in(t, {{-4, -4, -4}, 8}))
      for (const RationalPoint& p : piece.polygon) ASSERT_TRUE(inside(p, piece.voxel) && inside(p, t)) << text_of(t);
  }
}

class ExactClipOfSmallTriangles : public ExactClip {};

TEST_P(ExactClipOfSmallTriangles, AreasInHalfOpenVoxelsAddUpToTheTriangleExactly) {
  Rng rng(12);
  for (int i = 0; i < 150; ++i) {
    const Triangle t = random_triangle(GetParam(), {{-4, -4, -4}, 8}, rng);
    RationalPoint sum;
    for (const Piece& piece : pieces_in(t, around(t))) {
      if (!has_area_in_voxel(piece)) continue;
      const RationalPoint area = area_vector(piece.polygon);
      for (int r = 0; r < 3; ++r) sum[r] += area[r];
    }
    const auto whole = normal_of(t);
    for (int r = 0; r < 3; ++r) ASSERT_EQ(sum[r], mpq_class(whole[r])) << text_of(t);
  }
}

TEST_P(ExactClip, AreaAndThinVoxelsAreConservativeVoxels) {
  Rng rng(13);
  const Window window{{-4, -4, -4}, 8};
  for (int i = 0; i < 100; ++i) {
    const Triangle t = random_triangle(GetParam(), window, rng);
    const auto all = occupied(t, SurfaceRule::conservative, window);
    for (const SurfaceRule rule : {SurfaceRule::area, SurfaceRule::thin})
      for (const Voxel& v : occupied(t, rule, window)) ASSERT_TRUE(all.count(v)) << text_of(t);
  }
}

INSTANTIATE_TEST_SUITE_P(Random, ExactClip, testing::ValuesIn(all_families),
                         [](const auto& row) { return std::string(name_of(row.param)); });

INSTANTIATE_TEST_SUITE_P(Random, ExactClipOfSmallTriangles,
                         testing::ValuesIn(std::begin(all_families), std::end(all_families) - 2),
                         [](const auto& row) { return std::string(name_of(row.param)); });

TEST(ExactClipFigures, AHalfSquareInALatticePlaneHasHalfAVoxelOfAreaAboveIt) {
  const Triangle t{{{0, 0, 512}, {256, 0, 512}, {0, 256, 512}}};
  const Window window{{-2, -2, -2}, 8};
  EXPECT_EQ(occupied(t, SurfaceRule::area, window), (std::set<Voxel>{{0, 0, 2}}));
  EXPECT_EQ(occupied(t, SurfaceRule::conservative, window).size(), 18u - 2u);
  EXPECT_DOUBLE_EQ(area_voxel2(t), 0.5);
}

TEST(ExactClipFigures, TheDiagonalPlaneOfACubeHasTheAreaOfTheEquilateralTriangle) {
  const Triangle t{{{256, 0, 0}, {0, 256, 0}, {0, 0, 256}}};
  EXPECT_EQ(occupied(t, SurfaceRule::area, {{-2, -2, -2}, 8}), (std::set<Voxel>{{0, 0, 0}}));
  EXPECT_NEAR(area_voxel2(t), std::sqrt(3.0) / 2, 1e-15);
  const auto pieces = pieces_in(t, {{0, 0, 0}, 1});
  ASSERT_EQ(pieces.size(), 1u);
  for (const mpq_class& weight : centroid_barycentric(pieces[0], t)) EXPECT_EQ(weight, mpq_class(1, 3));
}

TEST(ExactClipFigures, AHalfVoxelTieGoesToTheVoxelThatOwnsTheLowerFace) {
  // Only centre segments along x hit the plane x = 256, at the end of voxel 0 and the start of voxel 1.
  const Triangle t{{{256, -512, -512}, {256, 2048, -512}, {256, -512, 2048}}};
  for (const Voxel& v : occupied(t, SurfaceRule::thin, {{-1, 0, 0}, 4})) EXPECT_EQ(v[0], 1);
  EXPECT_FALSE(crosses_centre_segment(t, {0, 0, 0}));
  EXPECT_TRUE(crosses_centre_segment(t, {1, 0, 0}));
}

}  // namespace
}  // namespace gigabake::reference
