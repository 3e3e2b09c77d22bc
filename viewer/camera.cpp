#include "viewer/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "format/brick_walk.h"
#include "format/error.h"

namespace gigabake {
namespace {

using Vector = std::array<double, 3>;

constexpr int largest_edge = 32768;
constexpr std::int64_t most_pixels = std::int64_t(1) << 28;
constexpr double farthest_voxel = double(std::int64_t(1) << 40);

Vector operator+(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector operator*(const Vector& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Vector& a) { return std::hypot(a[0], a[1], a[2]); }
Vector unit(const Vector& a) { return a * (1 / length(a)); }

void check_options(const CameraOptions& o) {
  if (o.width < 1 || o.height < 1 || o.width > largest_edge || o.height > largest_edge ||
      std::int64_t(o.width) * o.height > most_pixels)
    throw UsageError("--size: " + std::to_string(o.width) + "x" + std::to_string(o.height) +
                     " is no picture; expected 1 to 32768 a side and at most 2^28 pixels");
  if (!(o.fovy_deg >= 0.01 && o.fovy_deg <= 170)) throw UsageError("--fovy: expected 0.01 to 170 degrees");
  if (!(o.lod_bias >= -16 && o.lod_bias <= 16)) throw UsageError("--lod-bias: expected -16 to 16 levels");
}

/// Scene metres to voxels.
Vector to_voxels(const Point<Scene>& p_scene_m, const SceneDescription& scene, const char* option) {
  const Vector p_m{p_scene_m.x, p_scene_m.y, p_scene_m.z};
  Vector v;
  for (std::size_t a = 0; a < 3; ++a) {
    v[a] = (p_m[a] - scene.lattice_origin_m[a]) / scene.voxel_size_m;
    if (!std::isfinite(p_m[a])) throw UsageError(std::string(option) + ": expected three finite numbers");
    if (!(std::fabs(v[a]) <= farthest_voxel))
      throw UsageError(std::string(option) + ": more than 2^40 voxels from the scene's origin");
  }
  return v;
}

/// Orthonormal and right-handed: forward, right, up.
struct Axes {
  Vector forward, right, up;
};

Axes look(const Vector& forward, const std::optional<Point<Scene>>& up) {
  Vector upwards{0, 0, 1};
  if (up) {
    upwards = {up->x, up->y, up->z};
    const double size = length(upwards);
    if (!std::isfinite(size) || !(size > 0)) throw UsageError("--up: expected a finite direction other than 0,0,0");
    upwards = unit(upwards);
  } else if (std::fabs(forward[2]) > 1 - 1e-9) {
    upwards = {0, 1, 0};
  }
  const Vector right = cross(forward, upwards);
  if (!(length(right) > 1e-9)) throw UsageError("--up: the camera looks along it; choose another direction");
  return {forward, unit(right), cross(unit(right), forward)};
}

/// From the south-east, about 30° above the ground.
const Vector oblique_view{-0.62, 0.60, -0.505};

/// Where the camera stands to see every corner of the box, as near as it can: the frustum's four sides each touch one.
/// With a target it looks straight at that. The picture keeps a margin.
Vector framing_eye(const VoxelBox& box, const std::optional<Vector>& target, const Axes& axes, double tan_x,
                   double tan_y) {
  constexpr double margin = 0.97;
  double depth = HUGE_VAL;
  Vector eye{};
  for (const auto& [side, tan] : {std::pair{axes.right, tan_x * margin}, std::pair{axes.up, tan_y * margin}}) {
    double low = HUGE_VAL, high = -HUGE_VAL;  // where the frustum's two sides through the box cut the plane of depth 0
    for (int corner = 0; corner < 8; ++corner) {
      Vector p;
      for (std::size_t a = 0; a < 3; ++a) p[a] = corner >> a & 1 ? box.max[a] : box.min[a];
      low = std::min(low, dot(p, side) + tan * dot(p, axes.forward));
      high = std::max(high, dot(p, side) - tan * dot(p, axes.forward));
    }
    const double middle = target ? dot(*target, side) : (low + high) / 2;
    depth = std::min({depth, (low - middle) / tan, (middle - high) / tan});
    eye = eye + side * middle;
  }
  return eye + axes.forward * depth;
}

Vector middle(const VoxelBox& box) { return (box.min + box.max) * 0.5; }

void set(double out[3], const Vector& v) { std::copy(v.begin(), v.end(), out); }

}  // namespace

VoxelBox occupied_box(const SceneDescription& scene, const CellReader& reader) {
  VoxelBox box{{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
  for (std::size_t c = 0; c < scene.cells.size(); ++c) {
    const NodeTable nodes = reader.nodes(c);
    for (std::size_t n = 0; n < nodes.key.size(); ++n) {
      if (nodes.child_mask[n] != 0) continue;
      const BrickPosition at = brick_position(nodes.key[n]);
      const double edge = std::ldexp(brick_edge, nodes.lod[n]);
      const Vector low{at.x * edge, at.y * edge, at.z * edge};
      for (std::size_t a = 0; a < 3; ++a) {
        box.min[a] = std::min(box.min[a], double(scene.cells[c].lattice_min[a]) + low[a]);
        box.max[a] = std::max(box.max[a], double(scene.cells[c].lattice_min[a]) + low[a] + edge);
      }
    }
  }
  return box;
}

kernels::CastCamera make_camera(const CameraOptions& options, const SceneDescription& scene, const CellReader& reader) {
  check_options(options);
  const double tan_y = std::tan(options.fovy_deg * (std::numbers::pi / 360));
  const double tan_x = tan_y * options.width / options.height;
  std::optional<Vector> target, eye;
  if (options.target_m) target = to_voxels(*options.target_m, scene, "--target");
  if (options.eye_m) eye = to_voxels(*options.eye_m, scene, "--eye");
  Vector forward = unit(oblique_view);
  if (!eye) {
    eye = framing_eye(occupied_box(scene, reader), target, look(forward, options.up), tan_x, tan_y);
  } else {
    if (!target) target = middle(occupied_box(scene, reader));
    if (*target == *eye) throw UsageError("--target: the same place as --eye; there is no direction to look");
    forward = unit(*target - *eye);
  }
  const Axes axes = look(forward, options.up);

  kernels::CastCamera camera;
  set(camera.eye, *eye);
  set(camera.forward, axes.forward);
  set(camera.right, axes.right * tan_x);
  set(camera.up, axes.up * tan_y);
  camera.width = options.width;
  camera.height = options.height;
  camera.lod1_depth = std::exp2(1 - options.lod_bias) * options.height / (2 * tan_y);
  return camera;
}

}  // namespace gigabake
