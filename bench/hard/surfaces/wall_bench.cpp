#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/accuracy/linear_picture.h"
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

/// Returns true if the axis of the normal that a pixel shows is more than max_normal_deg from the wall's axis.
bool is_wrong_normal(const std::uint8_t* rgba, const Vec3d& normal) {
  Vec3d shown;
  for (std::size_t a = 0; a < 3; ++a) shown[a] = rgba[a] * 2 / 255.0 - 1;
  const double size = std::hypot(shown[0], shown[1], shown[2]);
  return !(std::fabs(dot(shown, normal)) >= size * std::cos(max_normal_deg * std::numbers::pi / 180)) || size == 0;
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
  Mean wrong;
  for (const WallView& view : views) {
    const Picture normals = baked.image(view.camera, ViewMode::normal);
    for (std::size_t i = 0; i < view.inner.size(); ++i)
      if (view.inner[i]) wrong.add(is_wrong_normal(&normals.rgba[4 * i], view.normal) ? 1 : 0);
  }
  result.figures.push_back(bounded(wall.name, "normals beyond 30°", "", wrong.value(), no_wrong_normals));
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
