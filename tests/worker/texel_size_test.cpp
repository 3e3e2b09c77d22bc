#include "worker/scan/texel_size.h"

#include <cmath>
#include <gtest/gtest.h>

namespace gigabake {
namespace {

/// A PNG of 2 × 2 grey texels.
const std::vector<std::uint8_t> png = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
    0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x00, 0x00, 0x00, 0x00, 0x57, 0xdd, 0x52, 0xf8, 0x00, 0x00, 0x00,
    0x0e, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x68, 0x68, 0x60, 0x68, 0x68, 0x00, 0x00, 0x06, 0x06, 0x02,
    0x01, 0x2c, 0xc1, 0x50, 0xd7, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

/// Returns a square of 4 × 4 m whose corners have these texture coordinates, placed `scale` times as large.
TileMesh square(float u, float v, double scale, bool textured) {
  TileMesh mesh;
  Primitive& p = mesh.primitives.emplace_back();
  p.position = {0, 0, 0, 4, 0, 0, 4, 4, 0, 0, 4, 0};
  p.index = {0, 1, 2, 0, 2, 3};
  p.uv = {0, 0, u, 0, u, v, 0, v};
  mesh.materials.emplace_back().texture.image = textured ? 0 : -1;
  mesh.images.push_back({"grey.png", png});
  Instance& i = mesh.instances.emplace_back();
  for (std::size_t k = 0; k < 3; ++k) i.scene_from_local.m[k][k] = scale;
  return mesh;
}

TEST(TexelSize, IsWhatATexelTakesOfTheSurface) {
  EXPECT_NEAR(texel_size(square(1, 1, 1, true)).mean_m(), 2, 1e-6);    // 2 × 2 texels on 4 × 4 m
  EXPECT_NEAR(texel_size(square(4, 4, 1, true)).mean_m(), 0.5, 1e-6);  // repeated four times
  EXPECT_NEAR(texel_size(square(1, 1, 10, true)).mean_m(), 20, 1e-6);
  EXPECT_NEAR(texel_size(square(4, 1, 1, true)).mean_m(), 1, 1e-6);  // the root of the area if texels are not square
  EXPECT_EQ(texel_size(square(1, 1, 1, false)).mean_m(), 0);
  EXPECT_EQ(texel_size(square(0, 0, 1, true)).mean_m(), 0);
}

TEST(TexelSize, OfSeveralTilesWeighsByArea) {
  TexelSize sum = texel_size(square(1, 1, 1, true));
  sum.add(texel_size(square(4, 4, 1, true)));
  EXPECT_NEAR(sum.mean_m(), 1, 1e-6);
}

}  // namespace
}  // namespace gigabake
