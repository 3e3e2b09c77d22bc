/// Vertex normals of a source determine the shading normals of voxels.
#include "kernels/body/voxelize/vertex_normals.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/math/octahedral.h"
#include "core/octree/morton.h"
#include "core/octree/plane.h"
#include "kernels/cpu/bake_cell.h"

namespace gigabake::kernels {
namespace {

constexpr double middle = 32, degree = 57.29577951308232;

/// An ellipsoid of 8 × 16 facets around the middle of a window of 64 voxels. Its half axes are the scale of the
/// instance; a negative scale mirrors.
struct Ellipsoid {
  Vec3d scale{28, 28, 28};
  std::vector<float> position;
  std::vector<std::uint32_t> index;
  std::vector<VertexNormal> normal;
  MaterialView material;

  /// `turned` is -1 for vertex normals that point inwards.
  explicit Ellipsoid(const Vec3d& half_axes, double turned = 1) : scale(half_axes) {
    constexpr std::uint32_t rows = 8, columns = 16;
    for (std::uint32_t row = 0; row <= rows; ++row)
      for (std::uint32_t column = 0; column < columns; ++column) {
        const double polar = row * std::numbers::pi / rows, around = column * 2 * std::numbers::pi / columns;
        const Vec3d p{std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar)};
        for (const double x : p) position.push_back(float(x));
        normal.push_back(encode_vertex_normal(p * turned));
        if (row == rows) continue;
        const std::uint32_t a = row * columns + column, b = row * columns + (column + 1) % columns;
        index.insert(index.end(), {a, a + columns, b + columns, a, b + columns, b});
      }
  }

  CellVolume bake(bool with_normals) const {
    PartView part;
    part.position = {position.data(), position.size()};
    part.index = {index.data(), index.size()};
    if (with_normals) part.normal = {normal.data(), normal.size()};
    for (std::size_t a = 0; a < 3; ++a) {
      part.scene_from_local[5 * a] = scale[a];
      part.scene_from_local[4 * a + 3] = middle;
    }
    CellParameters parameters;
    parameters.window_voxels = 64;
    return bake_cell({{&part, 1}, {&material, 1}, {}}, parameters, ThreadPool(1));
  }

  /// Returns the point of a triangle at (u, v); u and v are 0 to 1.
  Vec3d point(std::size_t triangle, double u, double v) const {
    const double c = std::sqrt(u), weight[3] = {1 - c, c * (1 - v), c * v};
    Vec3d p = Vec3d::all(middle);
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t a = 0; a < 3; ++a) p[a] += weight[k] * scale[a] * position[3 * index[3 * triangle + k] + a];
    return p;
  }

  /// Returns the unit normal of the ellipsoid below a point.
  Vec3d at(const Vec3d& p) const {
    const Vec3d n = Vec3d::by_axis([&](std::size_t a) { return (p[a] - middle) / (scale[a] * scale[a]); });
    return n / std::sqrt(dot(n, n));
  }
};

/// Calls visit(centre in voxels of lod 0, number of the voxel) for each voxel.
template <class Visit>
void for_each_voxel(const Level& level, int lod, const Visit& visit) {
  std::size_t voxel = 0;
  for (std::size_t b = 0; b < level.key.size(); ++b) {
    const BrickCoordinate brick = demorton(level.key[b]);
    for (int i = 0; i < brick_voxels; ++i)
      if ((level.mask[8 * b + std::size_t(i >> 6)] >> (i & 63) & 1) != 0)
        visit(Vec3d{brick.x * 8 + (i & 7) + 0.5, brick.y * 8 + (i >> 3 & 7) + 0.5, brick.z * 8 + (i >> 6) + 0.5} *
                  double(1 << lod),
              voxel++);
  }
}

/// Returns the mean angle in degrees between the voxels' normals and the ellipsoid's.
double mean_angle(const Ellipsoid& shape, const CellVolume& volume, int lod) {
  const Level& level = volume.levels.at(std::size_t(lod));
  double sum = 0, count = 0;
  for_each_voxel(level, lod, [&](const Vec3d& centre, std::size_t voxel) {
    double n[3];
    decode_octahedral(&level.normal[2 * voxel], n);
    sum += std::acos(std::fmin(1, dot(Vec3d{n[0], n[1], n[2]}, shape.at(centre)))) * degree;
    ++count;
  });
  return sum / count;
}

/// Returns the fraction of the voxels whose whole surface lies on their plane.
double planar_fraction(const CellVolume& volume, int lod) {
  const Level& level = volume.levels.at(std::size_t(lod));
  double planar = 0, count = 0;
  for_each_voxel(level, lod, [&](const Vec3d&, std::size_t voxel) {
    const std::size_t plane = directional_coverage_bytes * voxel + directional_coverage_plane;
    planar += is_fully_planar(level.directional_coverage[plane]) ? 1 : 0;
    ++count;
  });
  return planar / count;
}

/// Returns the RMS distance of points on the facets from the full planes of their voxels, in edges of these voxels.
double distance_from_planes(const Ellipsoid& shape, const CellVolume& volume, int lod) {
  const Level& level = volume.levels.at(std::size_t(lod));
  const double edge = double(1 << lod);
  std::map<Vec3i64, std::size_t> voxel_at;
  const auto place_of = [edge](const Vec3d& p) {
    return Vec3i64::by_axis([&](std::size_t a) { return std::int64_t(std::floor(p[a] / edge)); });
  };
  for_each_voxel(level, lod, [&](const Vec3d& centre, std::size_t voxel) { voxel_at[place_of(centre)] = voxel; });
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  double sum = 0, count = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3d p = shape.point(std::size_t(i) % (shape.index.size() / 3), unit(random), unit(random));
    const auto found = voxel_at.find(place_of(p));
    if (found == voxel_at.end()) continue;  // the point is on a face between two voxels
    const std::size_t voxel = found->second;
    const std::uint8_t plane =
        level.directional_coverage[directional_coverage_bytes * voxel + directional_coverage_plane];
    if (!is_fully_planar(plane)) continue;
    const OctahedronPoint n = octahedron_point(&level.normal[2 * voxel]);
    const Vec3d direction = Vec3d(n.c), half_edges = (p - (Vec3d(found->first) + Vec3d::all(0.5)) * edge) * (2 / edge);
    const double above = dot(direction, half_edges) / 127 - unpack_plane(plane).offset / double(max_offset);
    const double off = above * 127 / std::sqrt(dot(direction, direction)) / 2;
    sum += off * off;
    ++count;
  }
  return std::sqrt(sum / count);
}

TEST(VertexNormals, MakeAFacetedSphereSmooth) {
  const Ellipsoid sphere({28, 28, 28});
  const CellVolume faceted = sphere.bake(false), smooth = sphere.bake(true);
  for (const int lod : {0, 1, 2}) {
    EXPECT_GT(mean_angle(sphere, faceted, lod), 4) << "lod " << lod;
    EXPECT_LT(mean_angle(sphere, smooth, lod), 2) << "lod " << lod;
  }
}

TEST(VertexNormals, ChangeNoOtherChannelOfTheFinestLevel) {
  const Ellipsoid sphere({28, 28, 28});
  const Level faceted = sphere.bake(false).levels.at(0), smooth = sphere.bake(true).levels.at(0);
  EXPECT_EQ(faceted.key, smooth.key);
  EXPECT_EQ(faceted.mask, smooth.mask);
  EXPECT_EQ(faceted.rgba, smooth.rgba);
}

TEST(VertexNormals, AreTransformedByTheInverseTransposeAlsoIfTheInstanceMirrors) {
  for (const double mirror : {1.0, -1.0}) {
    const Ellipsoid shape({mirror * 28, 14, 20});
    EXPECT_LT(mean_angle(shape, shape.bake(true), 0), 2) << "mirror " << mirror;
  }
}

TEST(VertexNormals, DoNotTurnASurfaceInsideOut) {
  const Ellipsoid inwards({28, 28, 28}, -1);
  EXPECT_LT(mean_angle(inwards, inwards.bake(true), 0), 2);
}

TEST(VertexNormals, KeepThePlanesOfCoarserLevels) {
  const Ellipsoid sphere({28, 28, 28});
  const CellVolume faceted = sphere.bake(false), smooth = sphere.bake(true);
  for (const int lod : {1, 2}) {
    EXPECT_GT(planar_fraction(smooth, lod), planar_fraction(faceted, lod) - 0.02) << "lod " << lod;
    const double of_faceted = distance_from_planes(sphere, faceted, lod),
                 of_smooth = distance_from_planes(sphere, smooth, lod);
    RecordProperty("lod_" + std::to_string(lod), std::to_string(of_faceted) + " to " + std::to_string(of_smooth));
    EXPECT_LT(of_smooth, of_faceted + 0.02) << "lod " << lod;
  }
}

TEST(VertexNormals, TurnTheNormalByAtMost22Point5Degrees) {
  const Vec3<std::int16_t> up{0, 0, 32767};
  for (int angle = 0; angle <= 180; angle += 3) {
    const Vec3<std::int16_t> n = turned_toward({std::sin(angle / degree), 0, std::cos(angle / degree)}, up);
    const double turned = std::atan2(n[0], n[2]) * degree;
    EXPECT_NEAR(turned, angle > 90 ? 0 : std::fmin(angle, 22.5), 0.01) << angle;
    EXPECT_NEAR(std::sqrt(dot(Vec3d(n), Vec3d(n))), 32767, 1) << angle;
  }
}

TEST(VertexNormals, WithoutDirectionAreReplacedByTheNormalOfTheTriangle) {
  Ellipsoid sphere({28, 28, 28});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t v = 0; v < sphere.normal.size(); ++v)
    sphere.normal[v] = encode_vertex_normal(v % 2 == 0 ? Vec3d{0, 0, 0} : Vec3d{nan, 1, 0});
  EXPECT_EQ(sphere.bake(true).content_hash, sphere.bake(false).content_hash);
}

}  // namespace
}  // namespace gigabake::kernels
