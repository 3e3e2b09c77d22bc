/// Compositing of translucent surfaces along a ray.
#include <gtest/gtest.h>
#include <random>

#include "kernels/marching/cast.h"

namespace gigabake::kernels {
namespace {

/// Returns the transmittance of one translucent surface whose samples are `apart` voxels from each other along the ray.
float light_through(float density, const std::vector<float>& pieces, double apart) {
  CastRay ray;
  double distance = 1000;
  for (const float piece : pieces) {
    stay_in_surface(distance, 1, 1, ray);
    ray.transmittance -= stop_light(covered_in_surface(piece, density, ray), 0, density, ray);
    distance += apart;
  }
  return ray.transmittance;
}

TEST(Pane, HidesWhatItDoesHoweverManyPiecesOfItARayMeets) {
  const std::uint64_t seed = 20261123;
  std::mt19937_64 random(seed);
  for (int i = 0; i < 1000; ++i) {
    const float density = float(1 + random() % 254) / 255;
    std::vector<float> pieces(1 + random() % 9);
    for (float& piece : pieces) piece = density * float(1 + random() % 1000) / 1000;
    pieces.push_back(density);
    ASSERT_NEAR(light_through(density, pieces, 0.5), 1 - density, 1e-5) << "seed " << seed << " case " << i;
  }
}

TEST(Pane, HidesOfWhatOthersBeforeItLeave) {
  EXPECT_NEAR(light_through(0.3f, {0.3f, 0.3f, 0.3f}, 5), 0.7 * 0.7 * 0.7, 1e-6);
}

TEST(Pane, LeavesOpaqueSurfaceBehindItOpaque) {
  CastRay ray;
  stay_in_surface(1000, 1, 1, ray);
  ray.transmittance -= stop_light(covered_in_surface(1, 0.3f, ray), 0, 0.3f, ray);
  EXPECT_NEAR(ray.transmittance, 0.7f, 1e-6f);
  ray.transmittance -= stop_light(covered_in_surface(0.8f, 1, ray), 0, 1, ray);
  EXPECT_NEAR(ray.transmittance, 0, 1e-6f);
}

// At a grazing angle the samples of a translucent surface lie far apart along the ray, but count as one surface.
TEST(Pane, IsOneWhereARayGoesAlongIt) {
  CastRay ray;
  for (int i = 0; i < 5; ++i) {
    stay_in_surface(1000 + 20 * i, 0.05f, 1, ray);
    ray.transmittance -= stop_light(covered_in_surface(0.2f, 0.3f, ray), 0, 0.3f, ray);
  }
  EXPECT_NEAR(ray.transmittance, 0.7f, 1e-6f);
}

// Between two parallel surfaces the blended signed distance changes its sign a third time.
TEST(Pane, IsNotMetBetweenTwoSheets) {
  CastLine line{};
  line.direction[2] = -1;
  CastRay ray;
  ray.signed_distance = -0.4f;
  EXPECT_TRUE(is_between_surfaces({1, {0, 0, 127}, 0}, line, ray));
  ray.signed_distance = 0.4f;
  EXPECT_FALSE(is_between_surfaces({1, {0, 0, 127}, 0}, line, ray));
  EXPECT_TRUE(is_between_surfaces({1, {0, 0, -127}, 0}, line, ray)) << "its other side";
  ray.signed_distance = CastRay::no_signed_distance;
  EXPECT_FALSE(is_between_surfaces({1, {0, 0, 127}, 0}, line, ray)) << "it begins here";
}

}  // namespace
}  // namespace gigabake::kernels
