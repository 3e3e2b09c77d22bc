// Tests which pixels reuse the shadow samples of their block and which pixels cast separate rays.
#include "kernels/light/shadow_reuse.h"

#include <gtest/gtest.h>
#include <vector>

namespace gigabake::kernels {
namespace {

constexpr int tile_edge = 2 * sky_block;
constexpr int sun = int(LightRay::sun), sky = int(LightRay::sky);

/// An image of flat ground with one voxel per pixel. The first rays have ended, and all pixels are fully lit.
struct Ground {
  CastTile tile{0, 0, tile_edge, tile_edge};
  CastLighting lighting;
  std::vector<PixelLight> lights{std::size_t(tile_edge) * tile_edge};

  Ground() {
    lighting.light.to_sun[2] = 1;
    for (auto& direction : lighting.sun) direction[2] = 1;
    for (auto& direction : lighting.sky) direction[2] = 1;
    for (int y = 0; y < tile_edge; ++y)
      for (int x = 0; x < tile_edge; ++x) {
        PixelLight& light = at(x, y);
        light.at[0] = float(x);
        light.at[1] = float(y);
        light.facing = 1;
        light.has_surface = true;
        light.done = PixelLight::all;
        for (const LightRay ray : {LightRay::sun, LightRay::sky})
          if (is_cast_first(x, y, ray)) see(light, ray, 1);
      }
  }

  static void see(PixelLight& light, LightRay ray, float seen) {
    light.first |= 1u << int(ray);
    light.seen[int(ray)] = seen;
  }

  PixelLight& at(int x, int y) { return lights[std::size_t(y) * tile_edge + std::size_t(x)]; }

  void share() {
    for (int y = 0; y < tile_edge; ++y)
      for (int x = 0; x < tile_edge; ++x) reuse_shadow_samples({lights.data(), tile}, lighting, x, y, at(x, y));
  }

  /// Returns the number of pixels of [x0, x0 + size) × [y0, y0 + size) that cast a separate ray.
  int own_rays(LightRay ray, int x0, int y0, int size) {
    int count = 0;
    for (int y = y0; y < y0 + size; ++y)
      for (int x = x0; x < x0 + size; ++x) count += at(x, y).has(int(ray)) ? 0 : 1;
    return count;
  }
};

TEST(LightSharing, HasAQuarterOfThePixelsCastToTheSunFirstAndHalfToTheSky) {
  int to_sun = 0, to_sky = 0;
  for (int y = 0; y < sky_block; ++y)
    for (int x = 0; x < sky_block; ++x) {
      to_sun += is_cast_first(x, y, LightRay::sun) ? 1 : 0;
      to_sky += is_cast_first(x, y, LightRay::sky) ? 1 : 0;
    }
  EXPECT_EQ(to_sun, sky_block * sky_block / 4);
  EXPECT_EQ(to_sky, sky_directions);
}

TEST(LightSharing, GivesAllPixelsOfABlockWhatItsFirstRaysAgreeOn) {
  for (const float seen : {0.0f, 1.0f}) {
    Ground ground;
    for (PixelLight& light : ground.lights)
      if (light.is_first(LightRay::sun)) light.seen[sun] = seen;
    ground.share();
    for (const PixelLight& light : ground.lights) {
      EXPECT_EQ(light.seen[sun], seen);
      EXPECT_EQ(light.done, PixelLight::all);
    }
  }
}

TEST(LightSharing, CastsARayToTheSunFromAllOtherPixelsOfABlockThatDisagreesAndOfNoOther) {
  for (const float seen : {0.0f, 0.5f}) {
    Ground ground;
    ground.at(sun_block + 2, 2).seen[sun] = seen;
    ground.share();
    EXPECT_EQ(ground.own_rays(LightRay::sun, sun_block, 0, sun_block), sun_block * sun_block * 3 / 4);
    EXPECT_EQ(ground.own_rays(LightRay::sun, 0, 0, tile_edge), sun_block * sun_block * 3 / 4);
  }
}

TEST(LightSharing, CastsOwnRaysFromAPixelThatShowsAnotherSurface) {
  Ground lower, turned;
  lower.at(1, 2).at[2] = -5;
  turned.at(1, 2).normal[0] = 0.8f;
  turned.at(1, 2).normal[2] = 0.6f;
  for (Ground* ground : {&lower, &turned}) {
    ground->share();
    EXPECT_FALSE(ground->at(1, 2).has(sun));
    EXPECT_EQ(ground->own_rays(LightRay::sun, 0, 0, tile_edge), 1);
    EXPECT_FALSE(ground->at(1, 2).has(sky));
    EXPECT_EQ(ground->own_rays(LightRay::sky, 0, 0, tile_edge), 1);
  }
}

TEST(LightSharing, AsksForThreePixelsOfTheSameSurface) {
  for (const int others : {1, 2}) {
    Ground ground;
    ground.at(0, 0).has_surface = false;
    ground.at(0, 0).first = 0;
    if (others == 2) ground.at(2, 0) = ground.at(0, 0);
    ground.share();
    EXPECT_EQ(ground.own_rays(LightRay::sun, 0, 0, tile_edge), others == 1 ? 0 : 3);
  }
}

// A pixel took the light of its block, although the sample next to it in the other block was dark.
TEST(LightSharing, CastsOwnRaysBetweenTwoSamplesThatDiffer) {
  for (const int edge : {6, sky_block}) {
    Ground ground;
    for (int y = 0; y < tile_edge; ++y)
      for (int x = edge; x < tile_edge; ++x) ground.at(x, y).seen[sun] = 0;
    ground.share();
    for (int y = 0; y < tile_edge; ++y) EXPECT_FALSE(ground.at(edge - 1, y).has(sun)) << edge << " " << y;
  }
}

// All pixels of a block of 8 × 8 had the same light of the sky: shade had blotches.
TEST(LightSharing, ChangesTheLightOfTheSkyGradually) {
  Ground ground;
  for (int y = 0; y < tile_edge; ++y)
    for (int x = 0; x < sky_block; ++x) ground.at(x, y).seen[sky] = 0;
  ground.share();
  for (int y = 0; y < tile_edge; ++y) {
    float before = 0;
    for (int x = 0; x < tile_edge; ++x) {
      float share = 0;
      EXPECT_TRUE(
          sky_around({ground.lights.data(), ground.tile}, ground.lighting, x, y, ground.at(x, y), SkyRays::all, share));
      EXPECT_GE(share, before) << x;
      EXPECT_LE(share, before + 1.0f / sky_block + 1e-6f);
      before = share;
    }
    EXPECT_EQ(before, 1);
  }
}

// Tiles of the image begin where regions do, so they have the same pixels as the whole image.
TEST(LightSharing, UsesNoPixelOfAnotherRegion) {
  const CastTile tile{0, 0, 2 * light_region + 3, light_region};
  for (const int edge : {sun_block, sky_block})
    for (int x = 0; x < tile.width; ++x) {
      const LightWindow window = window_around(tile, edge / 2, edge, x, light_region - 1);
      EXPECT_LE(window.x0, x);
      EXPECT_GT(window.x1, x);
      EXPECT_EQ(window.x0 / light_region, x / light_region);
      EXPECT_EQ((window.x1 - 1) / light_region, x / light_region);
      EXPECT_EQ(window.x1 - window.x0, x < 2 * light_region ? edge : 3);
      EXPECT_EQ(window.y0, light_region - edge);
    }
}

TEST(LightSharing, DoesNotDependOnTheOrderOfPixels) {
  Ground forwards;
  for (int i = 0; i < tile_edge * tile_edge; i += 7)
    if (forwards.lights[std::size_t(i)].is_first(LightRay::sun)) forwards.lights[std::size_t(i)].seen[sun] = 0;
  Ground backwards = forwards;
  forwards.share();
  for (int i = tile_edge * tile_edge - 1; i >= 0; --i)
    reuse_shadow_samples({backwards.lights.data(), backwards.tile}, backwards.lighting, i % tile_edge, i / tile_edge,
                         backwards.lights[std::size_t(i)]);
  for (std::size_t i = 0; i < forwards.lights.size(); ++i) {
    EXPECT_EQ(backwards.lights[i].done, forwards.lights[i].done);
    EXPECT_EQ(backwards.lights[i].seen[sun], forwards.lights[i].seen[sun]);
  }
}

}  // namespace
}  // namespace gigabake::kernels
