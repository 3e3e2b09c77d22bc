#include "viewer/pictures/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/error.h"

namespace gigabake {
namespace {

constexpr int max_image_edge = 32768;
constexpr std::int64_t max_pixels = std::int64_t(1) << 28;
constexpr double max_voxel = double(std::int64_t(1) << 40);

Vec3d unit(const Vec3d& a) { return a * (1 / length(a)); }

void check_options(const CameraOptions& o) {
  check_picture_size(o);
  if (!(o.fovy_deg >= 0.01 && o.fovy_deg <= 170)) throw UsageError("fovy_deg", "expected 0.01 to 170 degrees");
  check_pixel_error(o.pixel_error);
}

/// Converts scene metres to voxels.
Vec3d to_voxels(const Point<Scene>& p_scene_m, const SceneHeader& scene, const char* name) {
  const Vec3d p_m{p_scene_m.x, p_scene_m.y, p_scene_m.z};
  const Vec3d v = (p_m - scene.lattice_origin_m) / scene.voxel_size_m;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!std::isfinite(p_m[a])) throw UsageError(name, "expected three finite numbers");
    if (!(std::fabs(v[a]) <= max_voxel)) throw UsageError(name, "more than 2^40 voxels from the scene's origin");
  }
  return v;
}

/// An orthonormal, right-handed basis.
struct Axes {
  Vec3d forward, right, up;
};

Axes look(const Vec3d& forward, const std::optional<Point<Scene>>& up) {
  Vec3d upwards{0, 0, 1};
  if (up) {
    upwards = {up->x, up->y, up->z};
    const double size = length(upwards);
    if (!std::isfinite(size) || !(size > 0)) throw UsageError("up", "expected a finite direction other than 0,0,0");
    upwards = unit(upwards);
  } else if (std::fabs(forward[2]) > 1 - 1e-9) {
    upwards = {0, 1, 0};
  }
  const Vec3d right = cross(forward, upwards);
  if (!(length(right) > 1e-9)) throw UsageError("up", "the camera looks along it; choose another direction");
  return {forward, unit(right), cross(unit(right), forward)};
}

/// The direction of a view from the south-east, about 30° below the horizontal.
const Vec3d oblique_view{-0.62, 0.60, -0.505};

/// Calls visit(lowest corner, highest corner) for boxes that contain the occupied space, in lod-0 voxels. A box is the
/// part of a cell, or of a page of cells, inside the scene's bounds. Reads no file, so that a missing shard changes
/// nothing.
template <class Visit>
void for_each_occupied_box(const PagedScene& scene, const Visit& visit) {
  const Box3i64& bounds = scene.header().bounds;
  const auto visit_window = [&](const Box3i64& window) {
    const Box3i64 box = bounds.is_empty() ? window : intersection(window, bounds);
    // In a scene that was edited, a window may lie outside the bounds; it then counts whole.
    const Box3i64& shown = box.is_empty() ? window : box;
    visit(Vec3d(shown.min), Vec3d(shown.end));
  };
  for (const PageReference& page : scene.root().pages) visit_window(page.totals.window);
  for (const SceneCell& cell : scene.root().cells) visit_window(window_of(cell));
}

Vec3d middle_of(const PagedScene& scene) {
  Vec3d low = Vec3d::all(HUGE_VAL), high = Vec3d::all(-HUGE_VAL);
  for_each_occupied_box(scene, [&](const Vec3d& box_low, const Vec3d& box_high) {
    low = min_by_axis(low, box_low);
    high = max_by_axis(high, box_high);
  });
  return (low + high) * 0.5;
}

/// Two opposite sides of the frustum, moved outwards until all boxes lie between them. `low` and `high` are the
/// positions along `across` at which the sides intersect the plane of depth 0.
struct FrustumSides {
  Vec3d across;  ///< unit, from the low to the high side
  Vec3d low_normal, high_normal;
  double tan;
  double low = HUGE_VAL, high = -HUGE_VAL;

  FrustumSides(const Vec3d& unit_across, const Vec3d& forward, double tangent)
      : across(unit_across),
        low_normal(unit_across + forward * tangent),
        high_normal(unit_across - forward * tangent),
        tan(tangent) {}

  void include(const Vec3d& centre, const Vec3d& half) {
    const auto reach = [&](const Vec3d& n) {
      return half[0] * std::fabs(n[0]) + half[1] * std::fabs(n[1]) + half[2] * std::fabs(n[2]);
    };
    low = std::min(low, dot(centre, low_normal) - reach(low_normal));
    high = std::max(high, dot(centre, high_normal) + reach(high_normal));
  }
};

/// Returns the nearest eye from which the whole scene is visible. If `target` is set, it is in the middle of the image.
Vec3d framing_eye(const PagedScene& scene, const std::optional<Vec3d>& target, const Axes& axes, double tan_x,
                  double tan_y) {
  constexpr double margin = 0.96;
  FrustumSides sides[2] = {{axes.right, axes.forward, tan_x * margin}, {axes.up, axes.forward, tan_y * margin}};
  for_each_occupied_box(scene, [&](const Vec3d& low, const Vec3d& high) {
    for (FrustumSides& s : sides) s.include((low + high) * 0.5, (high - low) * 0.5);
  });
  double depth = HUGE_VAL;
  Vec3d eye{};
  for (const FrustumSides& s : sides) {
    const double middle = target ? dot(*target, s.across) : (s.low + s.high) / 2;
    depth = std::min({depth, (s.low - middle) / s.tan, (middle - s.high) / s.tan});
    eye = eye + s.across * middle;
  }
  return eye + axes.forward * depth;
}

kernels::CastClip cast_clip(const Clip& clip, const SceneHeader& scene) {
  kernels::CastClip out;
  if (clip.box_m) {
    out.min = to_voxels((*clip.box_m)[0], scene, "clip_box");
    out.max = to_voxels((*clip.box_m)[1], scene, "clip_box");
    for (int a = 0; a < 3; ++a)
      if (!(out.min[a] < out.max[a])) throw UsageError("clip_box", "expected the lowest corner first");
  }
  if (clip.plane) {
    const Vec3d towards{clip.plane->towards.x, clip.plane->towards.y, clip.plane->towards.z};
    if (!std::isfinite(length(towards)) || !(length(towards) > 0))
      throw UsageError("clip_plane", "expected a finite direction other than 0,0,0");
    out.normal = unit(towards);
    out.offset = dot(unit(towards), to_voxels(clip.plane->through_m, scene, "clip_plane"));
  }
  return out;
}

}  // namespace

void check_picture_size(const CameraOptions& o) {
  if (o.width < 1 || o.height < 1 || o.width > max_image_edge || o.height > max_image_edge ||
      std::int64_t(o.width) * o.height > max_pixels)
    throw UsageError("size", std::to_string(o.width) + "x" + std::to_string(o.height) +
                                 " is not an image size; expected 1 to 32768 per side and at most 2^28 pixels");
}

void check_pixel_error(double pixel_error) {
  if (!(pixel_error >= finest_pixel_error && pixel_error <= coarsest_pixel_error))
    throw UsageError("pixel_error", "expected 2^-16 to 2^16 pixels");
}

HeightRange occupied_heights(const PagedScene& scene) {
  HeightRange range{HUGE_VAL, -HUGE_VAL};
  for_each_occupied_box(scene, [&](const Vec3d& low, const Vec3d& high) {
    range.low = std::min(range.low, low[2]);
    range.high = std::max(range.high, high[2]);
  });
  return range.low < range.high ? range : HeightRange{};
}

kernels::CastCamera make_camera(const CameraOptions& options, const PagedScene& scene) {
  check_options(options);
  const double tan_y = std::tan(options.fovy_deg * (std::numbers::pi / 360));
  const double tan_x = tan_y * options.width / options.height;
  std::optional<Vec3d> target, eye;
  if (options.target_m) target = to_voxels(*options.target_m, scene.header(), "target_m");
  if (options.eye_m) eye = to_voxels(*options.eye_m, scene.header(), "eye_m");
  Vec3d forward = unit(oblique_view);
  if (!eye) {
    eye = framing_eye(scene, target, look(forward, options.up), tan_x, tan_y);
  } else {
    if (!target) target = middle_of(scene);
    if (*target == *eye) throw UsageError("target_m", "the same place as `eye_m`; there is no direction to look");
    forward = unit(*target - *eye);
  }
  const Axes axes = look(forward, options.up);

  kernels::CastCamera camera;
  camera.clip = cast_clip(options.clip, scene.header());
  camera.eye = *eye;
  camera.forward = axes.forward;
  camera.right = axes.right * tan_x;
  camera.up = axes.up * tan_y;
  camera.width = options.width;
  camera.height = options.height;
  camera.lod1_depth = 2 / options.pixel_error * options.height / (2 * tan_y);
  return camera;
}

}  // namespace gigabake
