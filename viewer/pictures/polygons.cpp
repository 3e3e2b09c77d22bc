#include "viewer/pictures/polygons.h"

#include <algorithm>
#include <cmath>

#include "kernels/marching/cast_line.h"
#include "kernels/marching/ray_light.h"

namespace gigabake {
namespace {

constexpr std::size_t rows_at_a_time = 8;
/// The minimum distance from the eye in lod-0 voxels. Closer parts of triangles are not rendered.
constexpr double nearest = 1e-6;

/// A triangle, and the pixels that it may cover: [x0, x1) × [y0, y1).
struct Placed {
  std::size_t triangle;
  Vec3d corner, second, third;  ///< corner: relative to the eye, in voxels; second, third: edges from `corner`
  int x0, y0, x1, y1;
};

/// The extent in image pixels of the part of a triangle in front of the eye.
struct Extent {
  double x0 = HUGE_VAL, y0 = HUGE_VAL, x1 = -HUGE_VAL, y1 = -HUGE_VAL;

  void include(const kernels::CastCamera& camera, const Vec3d& p) {
    const Vec3d &right = camera.right, &up = camera.up;
    const double depth = dot(p, camera.forward);
    const double x = (dot(p, right) / (dot(right, right) * depth) + 1) / 2 * camera.width;
    const double y = (1 - dot(p, up) / (dot(up, up) * depth)) / 2 * camera.height;
    x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
  }
};

/// Returns the pixel of the coordinate v plus `more` pixels, limited to 0 … count. A margin adds no hits, because each
/// pixel's ray is intersected with the triangle.
int pixel_at(double v, int count, int more) { return int(std::clamp(std::floor(v) + more, 0.0, double(count))); }

Placed place(const kernels::CastCamera& camera, std::size_t triangle, const std::array<Vec3d, 3>& p) {
  Extent extent;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d &a = p[k], &b = p[(k + 1) % 3];
    const double depth_a = dot(a, camera.forward), depth_b = dot(b, camera.forward);
    if (depth_a >= nearest) extent.include(camera, a);
    if ((depth_a < nearest) == (depth_b < nearest)) continue;
    const double part = (nearest - depth_a) / (depth_b - depth_a);
    extent.include(camera, a + (b - a) * part);
  }
  Placed out{triangle, p[0], p[1] - p[0], p[2] - p[0], 0, 0, 0, 0};
  if (!(extent.x0 <= extent.x1)) return out;
  out.x0 = pixel_at(extent.x0, camera.width, -1);
  out.x1 = pixel_at(extent.x1, camera.width, 2);
  out.y0 = pixel_at(extent.y0, camera.height, -1);
  out.y1 = pixel_at(extent.y1, camera.height, 2);
  return out;
}

std::vector<Placed> place_all(const PolygonMesh& mesh, const SceneHeader& scene, const kernels::CastCamera& camera) {
  std::vector<Placed> out;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Vec3d, 3> p;
    bool is_finite = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point<Scene>& m = mesh.triangles[t][k];
      p[k] = (Vec3d{m.x, m.y, m.z} - scene.lattice_origin_m) / scene.voxel_size_m - camera.eye;
      is_finite = is_finite && std::ranges::all_of(p[k], [](double v) { return std::isfinite(v); });
    }
    if (!is_finite) continue;
    const Placed placed = place(camera, t, p);
    if (placed.x0 < placed.x1 && placed.y0 < placed.y1) out.push_back(placed);
  }
  return out;
}

struct Met {
  double distance = HUGE_VAL;
  float second = 0, third = 0;  ///< barycentric weights of the second and third corner
};

/// Intersects the ray with the triangle.
/// Source  Möller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection".
Met meet(const Placed& at, const Vec3d& direction) {
  const Vec3d p = cross(direction, at.third);
  const double area = dot(at.second, p);
  if (area == 0) return {};
  const Vec3d from{-at.corner[0], -at.corner[1], -at.corner[2]};
  const double u = dot(from, p) / area;
  const Vec3d q = cross(from, at.second);
  const double v = dot(direction, q) / area, distance = dot(at.third, q) / area;
  if (!(u >= 0 && v >= 0 && u + v <= 1 && distance >= nearest)) return {};
  return {distance, float(u), float(v)};
}

/// Returns the radiance of the triangle towards the eye. Lights the side that faces the eye.
std::array<float, 4> lit(const std::array<float, 4>& colour, const Placed& at, const Vec3d& direction,
                         const kernels::CastLight& light) {
  Vec3d n = cross(at.second, at.third);
  const double scale = (dot(n, direction) > 0 ? -1 : 1) / std::sqrt(dot(n, n));
  float directional_coverage = 0, up = float(0.5 + 0.5 * n[2] * scale);
  for (std::size_t a = 0; a < 3; ++a) directional_coverage += float(n[a] * scale) * light.to_sun[a];
  std::array<float, 4> out{0, 0, 0, 1};
  for (std::size_t k = 0; k < 3; ++k)
    out[k] = colour[k] / colour[3] *
             (light.sun[k] * std::max(directional_coverage, 0.0f) + light.sky[k] * up + light.ground[k] * (1 - up));
  return out;
}

void put_haze(const kernels::CastHaze& haze, double distance, std::array<float, 4>& rgba) {
  const float through = kernels::exp_minus(float(distance) * haze.per_voxel);
  for (std::size_t k = 0; k < 3; ++k) rgba[k] = rgba[k] * through + haze.rgb[k] * (1 - through);
}

}  // namespace

PolygonPicture draw_polygons(const PolygonMesh& mesh, const SceneHeader& scene, const kernels::CastCamera& camera,
                             const kernels::CastLight& light, const kernels::CastHaze& haze, const ThreadPool& policy) {
  const std::size_t width = std::size_t(camera.width), pixels = width * std::size_t(camera.height);
  PolygonPicture out;
  out.distance.assign(pixels, kernels::CastPolygons::nowhere);
  out.rgba.assign(4 * pixels, 0);
  const std::vector<Placed> placed = place_all(mesh, scene, camera);
  policy.parallel_for(std::size_t(camera.height), rows_at_a_time, [&](std::size_t begin, std::size_t end, int) {
    for (const Placed& at : placed)
      for (int y = std::max(at.y0, int(begin)); y < std::min(at.y1, int(end)); ++y)
        for (int x = at.x0; x < at.x1; ++x) {
          const Vec3d direction = kernels::line_of_sight({}, camera, x, y).direction;
          const Met met = meet(at, direction);
          const std::size_t i = std::size_t(y) * width + std::size_t(x);
          if (!(float(met.distance) < out.distance[i])) continue;
          const std::array<float, 4> colour = mesh.colour(at.triangle, met.second, met.third);
          if (!(colour[3] >= 0.5f)) continue;
          std::array<float, 4> seen = lit(colour, at, direction, light);
          put_haze(haze, met.distance, seen);
          out.distance[i] = float(met.distance);
          std::copy(seen.begin(), seen.end(), &out.rgba[4 * i]);
        }
  });
  return out;
}

}  // namespace gigabake
