/// Normal maps of a source determine the shading normals of voxels. The expected normals are computed here from the
/// plate's own axes, without tangent frames of the program.
#include "kernels/body/voxelize/normal_maps.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/octree/morton.h"
#include "kernels/cpu/bake_cell.h"
#include "kernels/cpu/texture/texture.h"
#include "tests/random_seed.h"

namespace gigabake::kernels {
namespace {

constexpr double degrees = 57.29577951308232;
constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();

Vec3d unit(const Vec3d& v) { return v * (1 / std::sqrt(dot(v, v))); }
double angle(const Vec3d& a, const Vec3d& b) { return std::acos(std::fmin(1, dot(unit(a), unit(b)))) * degrees; }

std::uint8_t code_of(double x) { return std::uint8_t(std::floor((x + 1) / 2 * 255 + 0.5)); }

/// Returns a normal map of size² texels. `at(s, t)` is the vector at a texel's centre, in the image's axes.
Texture map_of(int size, const std::function<Vec3d(double, double)>& at) {
  std::vector<std::uint8_t> rgba;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const Vec3d n = at((x + 0.5) / size, (y + 0.5) / size);
      rgba.insert(rgba.end(), {code_of(n[0]), code_of(n[1]), code_of(n[2]), 255});
    }
  return Texture(std::move(rgba), size, size, TextureAlpha::ignore, 0, ThreadPool(1), TextureContent::directions);
}

Texture constant_map(const Vec3d& n) {
  return map_of(1, [&](double, double) { return n; });
}

/// A square of two triangles in the plane z = 0 of its axes, with edge 2, seen from +z.
struct Plate {
  std::vector<float> position{-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
  std::vector<std::uint32_t> index{0, 1, 2, 0, 2, 3};
  std::vector<float> uv{0, 1, 1, 1, 1, 0, 0, 0};  ///< s along x, t against y: the image is upright
  std::vector<VertexNormal> normal;
  std::vector<VertexTangent> tangent;
  Vec3d axis[3] = {{20, 0, 0}, {0, 20, 0}, {0, 0, 20}};  ///< columns of the instance's matrix, in voxels
  Vec3d middle{32, 32, 32.3};
  float scale = 1;

  CellVolume bake(const std::optional<Texture>& map) const {
    PartView part;
    part.position = {position.data(), position.size()};
    part.index = {index.data(), index.size()};
    part.normal = {normal.data(), normal.size()};
    part.normal_uv = {uv.data(), uv.size()};
    part.tangent = {tangent.data(), tangent.size()};
    part.normal_map.texture = map ? 0 : -1;
    part.normal_map.scale = scale;
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) part.scene_from_local[4 * r + c] = axis[c][r];
      part.scene_from_local[4 * r + 3] = middle[r];
    }
    const MaterialView material;
    const TextureView view = map ? map->view() : TextureView();
    CellParameters parameters;
    parameters.window_voxels = 64;
    return bake_cell({{&part, 1}, {&material, 1}, {&view, map ? 1u : 0u}}, parameters, ThreadPool(1));
  }

  /// Sets the tangent of all vertices, in the plate's axes.
  void set_tangent(const Vec3d& t, bool is_mirrored) { tangent.assign(4, encode_vertex_tangent(t, is_mirrored)); }
};

/// Calls visit(centre in voxels of lod 0, normal) for each voxel.
template <class Visit>
void for_each_normal(const CellVolume& volume, int lod, const Visit& visit) {
  const Level& level = volume.levels.at(std::size_t(lod));
  std::size_t voxel = 0;
  for (std::size_t b = 0; b < level.key.size(); ++b) {
    const BrickCoordinate brick = demorton(level.key[b]);
    for (int i = 0; i < brick_voxels; ++i) {
      if ((level.mask[8 * b + std::size_t(i >> 6)] >> (i & 63) & 1) == 0) continue;
      double n[3];
      decode_octahedral(&level.normal[2 * voxel++], n);
      visit(Vec3d{brick.x * 8 + (i & 7) + 0.5, brick.y * 8 + (i >> 3 & 7) + 0.5, brick.z * 8 + (i >> 6) + 0.5} *
                double(1 << lod),
            Vec3d{n[0], n[1], n[2]});
    }
  }
}

/// Returns the max angle in degrees between the voxels' normals and `expected`.
double max_angle(const CellVolume& volume, const Vec3d& expected) {
  double worst = 0;
  for_each_normal(volume, 0, [&](const Vec3d&, const Vec3d& n) { worst = std::fmax(worst, angle(n, expected)); });
  EXPECT_FALSE(volume.levels.empty());
  return worst;
}

const Vec3d tilted = unit({0.3, 0.15, 0.94});  // 19.6 degrees off the z axis
constexpr double tolerance = 1.3;              // octahedral bytes 0.96, codes of the map 0.35

TEST(NormalMaps, TurnThePlateWithAndWithoutTangents) {
  Plate plate;
  EXPECT_LT(max_angle(plate.bake(constant_map(tilted)), tilted), tolerance);
  plate.set_tangent({1, 0, 0}, false);
  EXPECT_LT(max_angle(plate.bake(constant_map(tilted)), tilted), tolerance);
  plate.normal.assign(4, encode_vertex_normal({0, 0, 1}));
  EXPECT_LT(max_angle(plate.bake(constant_map(tilted)), tilted), tolerance);
  EXPECT_GT(max_angle(plate.bake(std::nullopt), tilted), 19);
}

TEST(NormalMaps, AreMirroredWithTheTextureCoordinates) {
  Plate plate;
  plate.uv = {1, 1, 0, 1, 0, 0, 1, 0};
  const Vec3d expected{-tilted[0], tilted[1], tilted[2]};
  EXPECT_LT(max_angle(plate.bake(constant_map(tilted)), expected), tolerance);
  plate.set_tangent({-1, 0, 0}, true);
  EXPECT_LT(max_angle(plate.bake(constant_map(tilted)), expected), tolerance);
}

TEST(NormalMaps, TurnWithTheTextureCoordinates) {
  Plate plate;
  plate.uv = {0, 0, 0, 1, 1, 1, 1, 0};  // s along y, t along x: up on the image is -x
  const Vec3d expected{-tilted[1], tilted[0], tilted[2]};
  EXPECT_LT(max_angle(plate.bake(constant_map(tilted)), expected), tolerance);
  plate.set_tangent({0, 1, 0}, false);
  EXPECT_LT(max_angle(plate.bake(constant_map(tilted)), expected), tolerance);
}

/// An instance moves the bumps with the plate: the normal in its axes stays the same, also if it mirrors.
TEST(NormalMaps, FollowRotatedAndMirroredInstances) {
  const gigabake::test::RandomSeed seed;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> any;
  for (int i = 0; i < 64; ++i) {
    Plate plate;
    const Vec3d z = unit({any(random), any(random), any(random)}), x = unit(cross({any(random), any(random), 1}, z)),
                y = cross(z, x) * (i % 2 == 0 ? 1.0 : -1.0);
    plate.axis[0] = x * 20, plate.axis[1] = y * 20, plate.axis[2] = z * 20;
    if ((i & 2) != 0) plate.normal.assign(4, encode_vertex_normal({0, 0, 1}));
    if ((i & 4) != 0) plate.set_tangent({1, 0, 0}, false);
    const Vec3d expected = x * tilted[0] + y * tilted[1] + z * tilted[2];
    EXPECT_LT(max_angle(plate.bake(constant_map(tilted)), expected), tolerance) << seed << ", plate " << i;
  }
}

/// Normals that point to the back of the triangles describe the plate from its back. The whole frame is negated.
TEST(NormalMaps, AreNegatedWithNormalsOfTheOtherSide) {
  for (const double mirror : {1.0, -1.0}) {
    Plate plate;
    plate.axis[0][0] *= mirror;
    plate.normal.assign(4, encode_vertex_normal({0, 0, -1}));
    plate.set_tangent({1, 0, 0}, false);  // the bitangent is -z × x = -y
    const Vec3d expected{-mirror * tilted[0], tilted[1], tilted[2]};
    EXPECT_LT(max_angle(plate.bake(constant_map(tilted)), expected), tolerance) << mirror;
  }
}

TEST(NormalMaps, AreScaled) {
  Plate plate;
  plate.scale = 0.5;
  EXPECT_LT(max_angle(plate.bake(constant_map(tilted)), {tilted[0] / 2, tilted[1] / 2, tilted[2]}), tolerance);
  plate.scale = -0.5;
  EXPECT_LT(max_angle(plate.bake(constant_map(tilted)), {-tilted[0] / 2, -tilted[1] / 2, tilted[2]}), tolerance);
  plate.scale = 0;
  EXPECT_LT(max_angle(plate.bake(constant_map(tilted)), {0, 0, 1}), tolerance);
}

/// The map of the surface z = h(x, y) gives the normals of this surface, whatever the level.
TEST(NormalMaps, GiveTheNormalsOfTheSurfaceThatTheyDescribe) {
  constexpr double k = 2 * 3.14159265358979 * 1.5, steepest = 0.25;
  const auto surface_normal = [&](double x, double y) {  // x, y from -1 to 1
    return unit(
        {-steepest * std::cos(k * x) * std::cos(k * y / 2), steepest / 2 * std::sin(k * x) * std::sin(k * y / 2), 1});
  };
  const Texture map = map_of(128, [&](double s, double t) { return surface_normal(2 * s - 1, 1 - 2 * t); });
  const CellVolume volume = Plate().bake(map);
  for (const int lod : {0, 1}) {
    double sum = 0, count = 0;
    for_each_normal(volume, lod, [&](const Vec3d& centre, const Vec3d& n) {
      const double x = (centre[0] - 32) / 20, y = (centre[1] - 32) / 20, inside = 1 - (1 << lod) / 20.0;
      if (std::fabs(x) > inside || std::fabs(y) > inside) return;
      sum += angle(n, surface_normal(x, y)), ++count;
    });
    EXPECT_LT(sum / count, lod == 0 ? 0.8 : 1.5) << "lod " << lod;
  }
}

/// Bumps smaller than voxels average to the plate's own normal.
TEST(NormalMaps, AreFilteredLikeColours) {
  Plate plate;
  const Texture map = map_of(512, [](double s, double t) {
    const bool is_odd = ((int(s * 512) ^ int(t * 512)) & 1) != 0;
    return unit({is_odd ? 0.9 : -0.9, is_odd ? 0.2 : -0.2, 0.5});
  });
  EXPECT_LT(max_angle(plate.bake(map), {0, 0, 1}), tolerance);
}

TEST(NormalMaps, TurnTheNormalByAtMost22Point5Degrees) {
  const CellVolume volume = Plate().bake(constant_map({1, 0, 0.1}));
  EXPECT_LT(max_angle(volume, {std::sin(22.5 / degrees), 0, std::cos(22.5 / degrees)}), tolerance);
  for (const Vec3d& behind : {Vec3d{-1, -1, -1}, Vec3d{0, 0, -1}, Vec3d{1, 0, -0.2}})
    EXPECT_LT(max_angle(Plate().bake(constant_map(behind)), {0, 0, 1}), 22.5 + tolerance);
}

TEST(NormalMaps, ChangeNoOtherChannelOfTheFinestLevel) {
  const Level flat = Plate().bake(std::nullopt).levels.at(0), mapped = Plate().bake(constant_map(tilted)).levels.at(0);
  EXPECT_EQ(flat.key, mapped.key);
  EXPECT_EQ(flat.mask, mapped.mask);
  EXPECT_EQ(flat.rgba, mapped.rgba);
  EXPECT_NE(flat.normal, mapped.normal);
}

TEST(NormalMaps, WithoutADirectionAreNotUsed) {
  const std::vector<Hash128> without = Plate().bake(std::nullopt).content_hash;
  EXPECT_EQ(Plate().bake(constant_map({0, 0, 0})).content_hash, without) << "a texel of length zero";
  Plate point;
  point.uv.assign(8, 0.25f);
  EXPECT_EQ(point.bake(constant_map(tilted)).content_hash, without) << "no area on the image";
  Plate none;
  none.uv.clear();
  EXPECT_EQ(none.bake(constant_map(tilted)).content_hash, without) << "no coordinates";
}

TEST(NormalMaps, AreNotUsedByTrianglesWithUnusableCoordinates) {
  for (const float bad : {nan_value, std::numeric_limits<float>::infinity(), 1e9f}) {
    Plate plate;
    plate.uv[0] = bad;  // a vertex of both triangles
    const CellVolume volume = plate.bake(constant_map(tilted));
    EXPECT_EQ(volume.content_hash, Plate().bake(std::nullopt).content_hash);
    EXPECT_EQ(volume.stats.bad_uv, 2u);
  }
}

TEST(NormalMaps, UseTextureCoordinatesInPlaceOfTangentsWithoutADirection) {
  const std::vector<Hash128> computed = Plate().bake(constant_map(tilted)).content_hash;
  for (const Vec3d& bad : {Vec3d{0, 0, 0}, Vec3d{nan_value, 0, 1}, Vec3d{INFINITY, 0, 0}}) {
    Plate plate;
    plate.set_tangent({0, 1, 0}, true);
    plate.tangent[0] = encode_vertex_tangent(bad, true);
    EXPECT_EQ(plate.bake(constant_map(tilted)).content_hash, computed);
  }
}

TEST(NormalMaps, WithTangentsAlongTheNormalAreNotUsed) {
  Plate plate;
  plate.set_tangent({0, 0, 1}, false);
  EXPECT_EQ(plate.bake(constant_map(tilted)).content_hash, Plate().bake(std::nullopt).content_hash);
}

TEST(VertexTangentCode, KeepsADirectionAndASide) {
  const gigabake::test::RandomSeed seed;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> any;
  for (int i = 0; i < 100000; ++i) {
    const Vec3d t{any(random), any(random), any(random)};
    const VertexTangent code = encode_vertex_tangent(t, i % 2 == 1);
    EXPECT_EQ(has_mirrored_bitangent(code.data()), i % 2 == 1);
    EXPECT_LT(angle(decode_vertex_normal(code.data()), t), 0.008) << seed;
  }
}

}  // namespace
}  // namespace gigabake::kernels
