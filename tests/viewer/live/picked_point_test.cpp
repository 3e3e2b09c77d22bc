#include "viewer/live/picked_point.h"

#include <cmath>
#include <gtest/gtest.h>

#include "kernels/marching/cast.h"

namespace gigabake {
namespace {

/// Returns the rays of an image of 8 × 4 pixels with a vertical field of view of 90°. The eye is 100 voxels, of half a
/// metre each, above the scene's middle. It looks straight down, and north is up.
PictureRays straight_down() {
  PictureRays rays;
  rays.camera.width = 8;
  rays.camera.height = 4;
  rays.camera.eye[2] = 100;
  rays.camera.forward[2] = -1;
  rays.camera.right[0] = 2;
  rays.camera.up[1] = 1;
  rays.lattice_origin_m = {1000, 2000, 300};
  rays.voxel_size_m = 0.5;
  return rays;
}

/// Returns an image of level ground 100 voxels below the eye.
Picture level_ground(const PictureRays& rays) {
  Picture picture = blank_picture(rays.camera.width, rays.camera.height, PictureLight::srgb);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x)
      picture.depth[std::size_t(8 * y + x)] = float(100 * std::hypot(1, (x + 0.5) / 2 - 2, 1 - (y + 0.5) / 2));
  return picture;
}

TEST(PickedPoint, LiesWhereThePixelsRayEnds) {
  const PictureRays rays = straight_down();
  Picture picture = level_ground(rays);
  const auto point = picked_point(picture, rays, 0.99, 0.01);  // the upper right pixel
  ASSERT_TRUE(point);
  EXPECT_NEAR(point->at_m.x, 1000 + 50 * 1.75, 1e-4);
  EXPECT_NEAR(point->at_m.y, 2000 + 50 * 0.75, 1e-4);
  EXPECT_NEAR(point->at_m.z, 300, 1e-4);
  EXPECT_NEAR(point->distance_m, 50 * std::hypot(1, 1.75, 0.75), 1e-4);
  EXPECT_FALSE(point->place);
  EXPECT_TRUE(picked_point(picture, rays, 1, 1));  // (1, 1) belongs to the last pixel
  picture.depth[7] = kernels::CastRay::no_depth;
  EXPECT_FALSE(picked_point(picture, rays, 0.99, 0.01));
}

TEST(PickedPoint, HasAPlaceOnTheEarthWhereTheSceneHasOne) {
  PictureRays rays = straight_down();
  rays.lattice_origin_m = {-50 * 0.25, -50 * 0.25, 0};  // pixel 4, 1 then shows the scene's origin
  rays.origin = Geodetic{46.9, 8.3, 600};
  const auto point = picked_point(level_ground(rays), rays, 0.5, 0.3);
  ASSERT_TRUE(point && point->place);
  EXPECT_NEAR(point->place->latitude_deg, 46.9, 1e-10);
  EXPECT_NEAR(point->place->longitude_deg, 8.3, 1e-10);
  EXPECT_NEAR(point->place->height_m, 600, 1e-4);
}

TEST(PickedPoint, IsSaidInDegreesOnTheEarthElseInSceneMetres) {
  PickedPoint point{{3, -4.128, 0.5}, 20, {}};
  EXPECT_EQ(place_text(point), "3.00 -4.13 0.50, 20.00 m away");
  point.place = Geodetic{46.9, -8.3, 600.25};
  EXPECT_EQ(place_text(point), "lat 46.9000000° lon -8.3000000° 600.25 m, 20.00 m away");
}

TEST(PickedPoint, LiesSoFarFromAnother) {
  EXPECT_EQ(distance_text({{1, 2, 10}, 5, {}}, {{4, 6, -2}, 9, {}}), "13.00 m: 5.00 m horizontal, -12.00 m vertical");
}

}  // namespace
}  // namespace gigabake
