/// Normals of slivers and of triangles much smaller than a voxel, compared with exact normals of the scene's vertices.
///
/// The reference is computed in long double from the part's data. Bounds: docs/accuracy.md.
#include <gtest/gtest.h>

#include "bake_scene.h"
#include "kernels/body/voxelize/classify_triangle.h"
#include "kernels/body/voxelize/part.h"
#include "kernels/body/voxelize/triangle_bricks.h"
#include "triangle_families.h"

namespace gigabake::reference {
namespace {

using namespace gigabake::kernels;

constexpr double normal_error_deg = 0.06;

double between(Rng& rng, double low, double high) { return std::uniform_real_distribution<double>(low, high)(rng); }

Direction random_direction(Rng& rng) {
  for (;;) {
    const Direction d{between(rng, -1, 1), between(rng, -1, 1), between(rng, -1, 1)};
    const double squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    if (squared > 0.01 && squared < 1)
      return {d[0] / std::sqrt(squared), d[1] / std::sqrt(squared), d[2] / std::sqrt(squared)};
  }
}

/// Returns a triangle `length` long and about `width` wide, in sub-voxels. Its instance rotates, scales and may mirror
/// it, and moves one vertex to `at`.
Part random_part(double length, double width, const Direction& at, Rng& rng) {
  Part part;
  part.index = {0, 1, 2};
  const double scale = between(rng, 0.3, 3);
  const Direction along = random_direction(rng), across = random_direction(rng);
  for (std::size_t k = 0; k < 3; ++k) {
    const double along_m = along[k] * length / scale, across_m = across[k] * width / scale;
    part.position.resize(9);
    part.position[k] = 0;
    part.position[3 + k] = float(along_m);
    part.position[6 + k] = float(along_m * 0.6 + across_m);
  }
  const Direction x = random_direction(rng), z = cross(x, random_direction(rng)), y = cross(z, x);
  const double unit = std::sqrt(dot(y, y)), mirror = uniform(rng, 0, 1) == 0 ? -1 : 1;
  for (std::size_t r = 0; r < 3; ++r) {
    double* m = &part.scene_from_local[4 * r];
    m[0] = x[r] * scale;
    m[1] = y[r] / unit * scale;
    m[2] = z[r] / unit * scale * mirror;
    m[3] = at[r];
  }
  return part;
}

PartArrays arrays_of(const Part& part) {
  PartView view;
  view.position = {part.position.data(), part.position.size()};
  view.index = {part.index.data(), part.index.size()};
  std::copy(part.scene_from_local.begin(), part.scene_from_local.end(), view.scene_from_local);
  static const MaterialView white;
  return part_arrays({{}, {&white, 1}, {}}, view);
}

/// Returns the normal for the winding that the triangle has after the instance's map.
Direction exact_normal(const Part& part) {
  using Wide = Vec3<long double>;
  const auto edge_to = [&](std::size_t vertex) {
    const Wide local = Wide::from(&part.position[3 * vertex]) - Wide::from(part.position);
    return Wide::by_axis([&](std::size_t r) { return dot(Wide::from(&part.scene_from_local[4 * r]), local); });
  };
  const bool mirrored = determinant(part.scene_from_local.data()) < 0;
  const Wide n = cross(edge_to(1), edge_to(2)) * (mirrored ? -1 : 1);
  return Direction(n / length(n));
}

/// Snaps the part's first triangle. Returns false if the snapped triangle has no area.
bool snapped(const PartArrays& part, WindowTriangle& out) {
  BakeScene scene;
  const CellWindow window = window_of(scene.parameters);
  std::uint32_t v[3];
  triangle_vertices(part, 0, v);
  for (int i = 0; i < 3; ++i) out.p[i] = snap_vertex(window, part, v[i]);
  out.part = out.index = 0;
  return kernels::has_area<std::int64_t>(out.p);
}

Direction as_direction(const Vec3<std::int16_t>& n) { return {double(n[0]), double(n[1]), double(n[2])}; }

struct Shape {
  const char* name;
  double length, width;  ///< sub-voxels
  double snapped_deg;    ///< the snapped normal of the worst triangle is off by at least this angle
};

constexpr Shape shapes[] = {{"of 1/8 voxel", 32, 32, 5},
                            {"of a few sub-voxels", 3, 3, 60},
                            {"slivers across a voxel", 256, 0.3, 80},
                            {"slivers of 1 to a million", 3000, 0.003, 80}};

TEST(TriangleNormal, IsThatOfTheVerticesBeforeTheSnap) {
  const std::uint64_t seed = 61;
  Rng rng(seed);
  for (const Shape& shape : shapes) {
    double worst = 0, worst_snapped = 0;
    for (int i = 0; i < 4000; ++i) {
      const Direction at{between(rng, -1e5, 1e5), between(rng, -1e5, 1e5), between(rng, -1e5, 1e5)};
      const Part part = random_part(shape.length, shape.width, at, rng);
      const PartArrays arrays = arrays_of(part);
      WindowTriangle w;
      if (!snapped(arrays, w)) continue;
      const auto t = make_brick_triangle<std::int64_t>(w, {0, 0, 0});
      worst = std::max(worst, angle_deg(as_direction(triangle_normal(arrays, 0, t)), exact_normal(part)));
      worst_snapped = std::max(worst_snapped, angle_deg(as_direction(snapped_normal(t)), exact_normal(part)));
    }
    EXPECT_LE(worst, normal_error_deg) << shape.name << ", seed " << seed;
    EXPECT_GE(worst_snapped, shape.snapped_deg) << shape.name << ": the test shows nothing; seed " << seed;
  }
}

TEST(TriangleNormal, IsTheSnappedOneWhereTheSceneHasNoArea) {
  Part part;
  part.index = {0, 1, 2};
  part.position = {0, 0, 0, 100.3f, 100.3f, 0, 200.6f, 200.6f, 0};  // collinear before the snap, but not after it
  part.scene_from_local = {1, 0, 0, 0, 0.7, 0.1, 0, 0.45, 0, 0, 1, 0};
  const PartArrays arrays = arrays_of(part);
  WindowTriangle w;
  ASSERT_TRUE(snapped(arrays, w));
  const auto t = make_brick_triangle<std::int64_t>(w, {0, 0, 0});
  EXPECT_EQ(triangle_normal(arrays, 0, t), snapped_normal(t));
}

/// The normal does not depend on the brick, the width of integers or the snapped vertices.
TEST(TriangleNormal, HasTheSameBitsFromWhereverItIsAskedFor) {
  const std::uint64_t seed = 62;
  Rng rng(seed);
  for (int i = 0; i < 2000; ++i) {
    const Part part = random_part(300, i % 2 == 0 ? 300 : 1, {1000, 2000, 3000}, rng);
    const PartArrays arrays = arrays_of(part);
    WindowTriangle w;
    if (!snapped(arrays, w)) continue;
    const Vec3<std::int32_t> here{0, 0, 0}, there{2048, -2048, 4096};
    const auto normal = triangle_normal(arrays, 0, make_brick_triangle<std::int32_t, double>(w, here));
    ASSERT_EQ(triangle_normal(arrays, 0, make_brick_triangle<std::int64_t>(w, there)), normal) << "seed " << seed;
    ASSERT_EQ(triangle_normal(arrays, 0, make_brick_triangle<__int128>(w, there)), normal) << "seed " << seed;
  }
}

/// The scene has a triangle of an eighth of a voxel in the middle of every third voxel along each axis.
TEST(VoxelNormal, IsThatOfItsSmallTriangle) {
  const std::uint64_t seed = 63;
  Rng rng(seed);
  BakeScene scene;
  scene.set_window({0, 0, 0}, 32);
  std::map<Voxel, Direction> expected;
  for (std::int64_t i = 1; i < 32; i += 3)
    for (std::int64_t j = 1; j < 32; j += 3)
      for (std::int64_t k = 1; k < 32; k += 3) {
        const Direction at{256 * (double(i) + 0.5), 256 * (double(j) + 0.5), 256 * (double(k) + 0.5)};
        const Part part = random_part(32, between(rng, 1, 32), at, rng);
        expected[{i, j, k}] = exact_normal(part);
        scene.add_part(part);
      }
  const VoxelMap baked = voxels_at(scene.bake(), scene.parameters, 0);
  EXPECT_GT(baked.size(), expected.size() * 9 / 10);  // some triangles have no area after the snap
  for (const auto& [position, voxel] : baked)
    ASSERT_LE(angle_deg(direction_of(voxel.normal), expected.at(position)), octahedral_error_deg + 0.05)
        << "seed " << seed;
}

}  // namespace
}  // namespace gigabake::reference
