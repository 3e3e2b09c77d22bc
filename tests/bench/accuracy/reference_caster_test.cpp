// Compares the reference ray caster with closed forms: areas, mean colours and layers.
#include "bench/accuracy/reference_caster.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>

#include "tests/worker/glb_scene.h"
#include "viewer/pictures/image_files.h"

namespace gigabake::bench {
namespace {

BakeParameters lattice(double voxel_size_m) {
  BakeParameters parameters;
  parameters.voxel_size_m = voxel_size_m;
  parameters.lattice_origin_m = {3, -2, 1};
  return parameters;
}

/// Returns a horizontal square around the origin, 2·half_m wide and `up_m` above it.
GlbMesh quad(double half_m, double up_m) {
  const auto h = float(half_m), y = float(up_m);
  GlbMesh mesh;
  mesh.position = {-h, y, h, h, y, h, h, y, -h, -h, y, -h};
  mesh.index = {0, 1, 2, 0, 2, 3};
  return mesh;
}

std::string coloured(const std::string& rgba, const std::string& more = "") {
  return "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[" + rgba + "]}" + more + "}";
}

std::vector<std::uint8_t> png(int edge, const std::function<std::array<std::uint8_t, 4>(int, int)>& texel) {
  Picture picture{edge, edge, {}, {}};
  for (int y = 0; y < edge; ++y)
    for (int x = 0; x < edge; ++x)
      for (const std::uint8_t v : texel(x, y)) picture.rgba.push_back(v);
  const std::string bytes = encode_png(picture);
  return {bytes.begin(), bytes.end()};
}

GlbMesh textured(GlbMesh mesh, std::vector<std::uint8_t> image) {
  mesh.uv = {0, 1, 1, 1, 1, 0, 0, 0};
  mesh.image = std::move(image);
  return mesh;
}

/// Returns a camera 1000 m above the origin that views a square of 2·half_m at height 0; north is up.
kernels::CastCamera from_above(const BakeParameters& p, double half_m, int pixels) {
  kernels::CastCamera camera;
  const double eye_m[3] = {0, 0, 1000};
  for (int a = 0; a < 3; ++a) camera.eye[a] = (eye_m[a] - p.lattice_origin_m[std::size_t(a)]) / p.voxel_size_m;
  camera.forward[2] = -1;
  camera.right[0] = camera.up[1] = half_m / 1000;
  camera.width = camera.height = pixels;
  return camera;
}

struct Sum {
  double rgb[3] = {0, 0, 0}, alpha = 0;
  explicit Sum(const LinearPicture& picture) {
    for (std::size_t i = 0; i < picture.pixels(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) rgb[c] += picture.rgba[4 * i + c];
      alpha += picture.alpha(i);
    }
  }
};

class Reference : public testing::Test {
 protected:
  void SetUp() override {
    if (!ReferenceCaster::is_built()) GTEST_SKIP() << "built without Embree";
  }

  LinearPicture seen(const std::vector<GlbMesh>& meshes, double half_m, int pixels, int samples = 64, int threads = 2) {
    std::vector<std::string> files;
    for (const GlbMesh& mesh : meshes) {
      files.push_back(std::to_string(files.size()) + ".glb");
      write_glb(folder_.path() / files.back(), mesh);
    }
    const BakeParameters p = lattice(0.5);
    return ReferenceCaster(sources_of(folder_.path(), files), p, threads).draw(from_above(p, half_m, pixels), samples);
  }

  ScratchFolder folder_;
};

TEST_F(Reference, APlaneFillsThePictureWithItsColour) {
  GlbMesh mesh = quad(10, 0);
  mesh.material = coloured("0.2,0.5,0.8,0.3");
  const LinearPicture picture = seen({mesh}, 5, 16);
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    EXPECT_NEAR(picture.rgba[4 * i], 0.2, 1e-4);
    EXPECT_NEAR(picture.rgba[4 * i + 1], 0.5, 1e-4);
    EXPECT_NEAR(picture.rgba[4 * i + 2], 0.8, 1e-4);
    EXPECT_NEAR(picture.rgba[4 * i + 3], 1, 1e-4) << "an opaque material ignores alpha";
  }
}

TEST_F(Reference, PixelsLieWhereTheViewersDo) {
  GlbMesh mesh = quad(5, 0);
  for (std::size_t i = 0; i < mesh.position.size(); i += 3) {
    mesh.position[i] += 5;      // east
    mesh.position[i + 2] -= 5;  // north
  }
  const LinearPicture picture = seen({mesh}, 10, 16);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x)
      EXPECT_EQ(picture.alpha(std::size_t(16 * y + x)), x >= 8 && y < 8 ? 1 : 0) << x << " " << y;
}

TEST_F(Reference, ATexturedQuadHasTheMeanColourOfItsTexels) {
  const std::vector<std::uint8_t> image = png(8, [](int x, int y) {
    return std::array<std::uint8_t, 4>{std::uint8_t(30 * x), std::uint8_t(30 * y), std::uint8_t((x ^ y) & 1 ? 255 : 0),
                                       255};
  });
  const Sum sum(seen({textured(quad(10, 0), image)}, 12, 64));
  const LinearPicture texels = to_linear([&] {
    const Image decoded = decode_image({"image", image});
    return Picture{decoded.width, decoded.height, decoded.rgba, {}};
  }());
  const Sum mean(texels);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum.rgb[c] / sum.alpha, mean.rgb[c] / mean.alpha, 0.003) << c;
}

TEST_F(Reference, AMaskCoversWhereItsTexelsPass) {
  // The mask has squares of 4 × 4 texels. The lines at which alpha is one half are parallel to the squares' sides.
  GlbMesh mesh =
      textured(quad(10, 0), png(16, [](int x, int y) {
                 return std::array<std::uint8_t, 4>{255, 255, 255, std::uint8_t((x / 4 + y / 4) % 2 ? 255 : 0)};
               }));
  mesh.material = R"({"alphaMode":"MASK","alphaCutoff":0.5})";
  const Sum sum(seen({mesh}, 12, 64));
  EXPECT_NEAR(sum.alpha / std::pow(64 * 10.0 / 12, 2), 0.5, 0.01);
}

TEST_F(Reference, TranslucentLayersAddUpFrontToBack) {
  GlbMesh upper = quad(20, 2), middle = quad(20, 1), lower = quad(20, 0);
  upper.material = coloured("1,0,0,0.5", R"(,"alphaMode":"BLEND")");
  middle.material = coloured("0,1,0,0.25", R"(,"alphaMode":"BLEND")");
  lower.material = coloured("0,0,1,1");
  const LinearPicture all = seen({middle, lower, upper}, 5, 4), two = seen({middle, upper}, 5, 4);
  EXPECT_NEAR(all.rgba[0], 0.5, 1e-4);
  EXPECT_NEAR(all.rgba[1], 0.5 * 0.25, 1e-4);
  EXPECT_NEAR(all.rgba[2], 0.5 * 0.75, 1e-4);
  EXPECT_NEAR(all.rgba[3], 1, 1e-4);
  EXPECT_NEAR(two.rgba[3], 1 - 0.5 * 0.75, 1e-4);
}

GlbMesh sphere(double radius_m, int steps) {
  GlbMesh mesh;
  for (int j = 0; j <= steps; ++j)
    for (int i = 0; i <= 2 * steps; ++i) {
      const double latitude = std::numbers::pi * j / steps, longitude = std::numbers::pi * i / steps;
      mesh.position.insert(mesh.position.end(), {float(radius_m * std::sin(latitude) * std::cos(longitude)),
                                                 float(radius_m * std::cos(latitude)),
                                                 float(radius_m * std::sin(latitude) * std::sin(longitude))});
    }
  const auto vertex = [steps](int i, int j) { return std::uint32_t(j * (2 * steps + 1) + i); };
  for (int j = 0; j < steps; ++j)
    for (int i = 0; i < 2 * steps; ++i)
      mesh.index.insert(mesh.index.end(), {vertex(i, j), vertex(i, j + 1), vertex(i + 1, j), vertex(i + 1, j),
                                           vertex(i, j + 1), vertex(i + 1, j + 1)});
  return mesh;
}

TEST_F(Reference, ASpheresSilhouetteHasTheAreaOfItsCircle) {
  const Sum sum(seen({sphere(4, 200)}, 5, 64));
  // The eye is 1000 m above the sphere's centre. The cone of tangents to the sphere intersects height 0 in a circle
  // that is slightly larger than the sphere.
  const double radius_m = 4 / std::sqrt(1 - std::pow(4 / 1000.0, 2)), pixels_per_m = 64 / 10.0;
  EXPECT_NEAR(sum.alpha / (std::numbers::pi * std::pow(radius_m * pixels_per_m, 2)), 1, 0.002);
}

TEST_F(Reference, ThreadsDoNotShow) {
  EXPECT_EQ(seen({sphere(2, 30)}, 5, 32, 9, 1).rgba, seen({sphere(2, 30)}, 5, 32, 9, 3).rgba);
}

TEST_F(Reference, FarFromTheOriginIsAsNearIt) {
  write_glb(folder_.path() / "ball.glb", sphere(4, 30));
  SceneSources sources = sources_of(folder_.path(), {"ball.glb"});
  BakeParameters p = lattice(0.25);
  const LinearPicture near = ReferenceCaster(sources, p, 1).draw(from_above(p, 5, 32), 16);
  sources.tiles[0].scene_from_tile.m[0][3] += 1 << 20;
  kernels::CastCamera camera = from_above(p, 5, 32);
  camera.eye[0] += 4 << 20;
  const LinearPicture far = ReferenceCaster(sources, p, 1).draw(camera, 16);
  EXPECT_EQ(near.rgba, far.rgba);
}

TEST_F(Reference, TheFirstHitIsAsFarAsTheSurface) {
  write_glb(folder_.path() / "quad.glb", quad(10, 3));
  const ReferenceCaster caster(sources_of(folder_.path(), {"quad.glb"}), lattice(0.5), 1);
  const auto hit = caster.first_hit({-6, 4, 1000}, {0, 0, -1});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(*hit, 1000 - (3 - 1) / 0.5, 1e-3);
  EXPECT_FALSE(caster.first_hit({100, 4, 1000}, {0, 0, -1}));
}

}  // namespace
}  // namespace gigabake::bench
