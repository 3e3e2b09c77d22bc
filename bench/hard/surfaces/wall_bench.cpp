#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/accuracy/linear_picture.h"
#include "bench/exact/appearance.h"
#include "bench/hard/surfaces/baked_surface.h"
#include "bench/hard/surfaces/surface_bounds.h"
#include "viewer/light/sky.h"

namespace gigabake::bench {
namespace {

constexpr double max_normal_deg = 30, stripe_codes = 3;

/// One view of a wall: the camera, the side that it sees, and the pixels that show nothing but the wall.
struct WallView {
  CameraOptions camera;
  Vec3d normal;
  std::vector<bool> inner;
};

std::vector<WallView> views_of(const WallScene& wall) {
  const Vec3d up = cross(wall.along, wall.normal);
  std::vector<WallView> views;
  for (const double side : {1., -1.})
    for (const double voxels_per_pixel : {0.25, 1., 4.}) {
      const Vec3d normal = wall.normal * side;
      const Vec3d direction = unit_vector(normal * 0.83 + wall.along * 0.47 + up * 0.30);
      const CameraOptions camera =
          narrow_camera(wall.middle + normal * (wall.thickness / 2), direction, voxels_per_pixel, 120, 90);
      views.push_back({camera, normal, inner_pixels(silhouettes(wall.bodies, Pinhole(camera)))});
    }
  return views;
}

/// Fractions and means over inner pixels.
struct Mean {
  double sum = 0, pixels = 0;
  void add(double value) {
    sum += value;
    pixels += 1;
  }
  double value() const { return pixels > 0 ? sum / pixels : 0; }
};

/// Returns the fraction of the wall's voxels whose normal is more than max_normal_deg from the wall's axis, on either
/// side. Voxels at the wall's narrow sides are not counted.
double wrong_normals(const WallScene& wall, const BakedSurface& baked) {
  constexpr double narrow_side = 2;
  const Vec3d up = cross(wall.along, wall.normal);
  Mean wrong;
  baked.for_each_normal([&](const Vec3d& centre, const std::int8_t* normal) {
    const Vec3d from_middle = centre - wall.middle;
    if (std::fabs(dot(from_middle, wall.along)) > wall.length / 2 - narrow_side ||
        std::fabs(dot(from_middle, up)) > wall.height / 2 - narrow_side)
      return;
    const Vec3d stored = reference::direction_of({normal[0], normal[1]});
    wrong.add(std::fabs(dot(stored, wall.normal)) < std::cos(max_normal_deg * std::numbers::pi / 180) ? 1 : 0);
  });
  return wrong.value();
}

double linear_light(const Vec3d& normal, std::size_t channel) {
  const kernels::CastLight light = afternoon_light();
  const double sun = std::max(0.0, dot(normal, Vec3d::from(light.to_sun))), up = (1 + normal[2]) / 2;
  return surface_albedo * (light.sun[channel] * sun + light.sky[channel] * up + light.ground[channel] * (1 - up));
}

/// Differences of lit pixels from the light of the wall's side.
struct LightError {
  Mean off, stripes;
};

void add_light(const Picture& picture, const WallView& view, LightError& error) {
  for (std::size_t i = 0; i < view.inner.size(); ++i) {
    if (!view.inner[i]) continue;
    double off = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double alpha = std::max(1e-6, double(picture.linear[4 * i + 3]));
      const double shown = 255 * srgb_code(double(picture.linear[4 * i + c]) / alpha);
      off = std::max(off, std::fabs(shown - 255 * srgb_code(linear_light(view.normal, c))));
    }
    error.off.add(off);
    error.stripes.add(off > stripe_codes ? 1 : 0);
  }
}

}  // namespace

HardResult measure_wall(const WallScene& wall, BakedSurface& baked) {
  HardResult result;
  const std::vector<WallView> views = views_of(wall);
  result.figures.push_back(bounded(wall.name, "normals beyond 30°", "", wrong_normals(wall, baked), no_wrong_normals));
  for (const Shadows shadows : {Shadows::off, Shadows::on}) {
    LightError error;
    for (const WallView& view : views) add_light(baked.image(view.camera, ViewMode::lit, shadows), view, error);
    const std::string with = shadows == Shadows::on ? " with shadows" : "";
    result.figures.push_back(bounded(wall.name, "light" + with, "codes", error.off.value(), same_light_codes));
    result.figures.push_back(bounded(wall.name, "stripes" + with, "", error.stripes.value(), no_stripes));
  }
  return result;
}

}  // namespace gigabake::bench
