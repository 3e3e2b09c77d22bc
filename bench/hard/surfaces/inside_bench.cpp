#include "bench/hard/surfaces/baked_surface.h"
#include "bench/hard/surfaces/surface_bounds.h"

namespace gigabake::bench {
namespace {

/// Linear light of the sun above which a pixel counts as sunlit. A wall that faces the sun has more than 0.2.
constexpr float sunlit = 0.01f;
constexpr int edge = 64;

/// High in the south-west, and low in the south-east.
constexpr SunDirection suns[] = {{225, 42}, {140, 15}};

/// Returns a camera that looks from a point in a direction and shows a face of a cube around the point.
CameraOptions face_camera(const Vec3d& eye, const Vec3d& direction) {
  CameraOptions camera;
  camera.fovy_deg = 90;
  camera.width = camera.height = edge;
  const Vec3d target = eye + direction;
  camera.eye_m = {eye[0], eye[1], eye[2]};
  camera.target_m = {target[0], target[1], target[2]};
  return camera;
}

}  // namespace

HardResult measure_inside(const HouseScene& house, BakedSurface& baked) {
  double lit = 0, pixels = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double sign : {1., -1.}) {
      Vec3d direction{};
      direction[axis] = sign;
      for (const SunDirection& sun : suns) {
        const Picture picture = baked.image(face_camera(house.inside, direction), ViewMode::sun, Shadows::on, sun);
        for (std::size_t i = 0; i < picture.linear.size(); i += 4) lit += picture.linear[i] > sunlit ? 1 : 0;
        pixels += double(picture.linear.size()) / 4;
      }
    }
  HardResult result;
  result.figures.push_back(bounded(house.name, "sunlit inside", "", lit / pixels, dark_inside));
  return result;
}

}  // namespace gigabake::bench
