#include "viewer/live/scene_editor.h"

#include <algorithm>
#include <cmath>

#include "kernels/marching/cast_line.h"
#include "kernels/marching/pixel.h"
#include "viewer/live/cell_boxes.h"

namespace gigabake {
namespace {

/// A surface is drawn where its voxel is half covered, so its voxel lies behind the depth of a pixel.
constexpr double behind_surface = 0.5;

Vec3i64 voxel_at(const kernels::CastCamera& camera, int x, int y, float depth) {
  const kernels::CastLine line = kernels::line_of_sight({}, camera, x, y);
  return Vec3i64::by_axis([&](int axis) {
    return std::int64_t(std::floor(line.origin[axis] + line.direction[axis] * (double(depth) + behind_surface)));
  });
}

bool contains(const Box3i64& box, const Vec3i64& voxel) {
  bool is_inside = true;
  for (std::size_t c = 0; c < 3; ++c) is_inside = is_inside && box.min[c] <= voxel[c] && voxel[c] < box.end[c];
  return is_inside;
}

void tint(std::uint8_t* rgba, const std::array<std::uint8_t, 3>& rgb) {
  for (std::size_t c = 0; c < 3; ++c) rgba[c] = std::uint8_t((rgba[c] + 2 * rgb[c]) / 3);
}

/// The pixels of columns [left, right) in rows [top, bottom).
struct PixelRectangle {
  int left, top, right, bottom;
};

/// Returns a rectangle of all pixels whose lines of sight cross the box. It is the whole image if a part of the box is
/// behind the eye.
PixelRectangle pixels_around(const Box3i64& box, const kernels::CastCamera& camera, const Picture& picture) {
  constexpr double near_depth = 1e-3, margin = 1;  // the margin is larger than all rounding
  double left = HUGE_VAL, top = HUGE_VAL, right = -HUGE_VAL, bottom = -HUGE_VAL;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Vec3d v = Vec3d::by_axis(
        [&](int axis) { return double((corner >> axis & 1) != 0 ? box.end[axis] : box.min[axis]) - camera.eye[axis]; });
    const double depth = dot(v, camera.forward) / dot(camera.forward, camera.forward);
    if (!(depth > near_depth)) return {0, 0, picture.width, picture.height};
    const double x = (dot(v, camera.right) / dot(camera.right, camera.right) / depth + 1) / 2 * camera.width,
                 y = (1 - dot(v, camera.up) / dot(camera.up, camera.up) / depth) / 2 * camera.height;
    left = std::min(left, x), right = std::max(right, x);
    top = std::min(top, y), bottom = std::max(bottom, y);
  }
  const auto pixel = [](double at, int end) { return int(std::clamp(std::floor(at), 0.0, double(end))); };
  return {pixel(left - margin, picture.width), pixel(top - margin, picture.height),
          pixel(right + 1 + margin, picture.width), pixel(bottom + 1 + margin, picture.height)};
}

/// Tints the surfaces in columns [left, right) of a row that the edit selects.
void tint_row(Picture& picture, const PictureRays& rays, const EditPreview& preview, int y, int left, int right) {
  for (int x = left; x < right; ++x) {
    const std::size_t pixel = std::size_t(y) * std::size_t(picture.width) + std::size_t(x);
    const float depth = picture.depth[pixel];
    if (!(depth > 0 && depth < kernels::CastRay::no_depth)) continue;
    const Vec3i64 voxel = voxel_at(rays.camera, x, y, depth);
    if (contains(preview.bounds, voxel) && preview.selects(voxel)) tint(&picture.rgba[4 * pixel], preview.rgb);
  }
}

}  // namespace

void draw_previews(Picture& picture, const PictureRays& rays, const EditPreviews& previews, const ThreadPool& pool) {
  constexpr std::size_t rows = 8;
  for (const EditPreview& preview : previews) {
    const PixelRectangle around = pixels_around(preview.bounds, rays.camera, picture);
    pool.parallel_for(std::size_t(std::max(0, around.bottom - around.top)), rows,
                      [&](std::size_t begin, std::size_t end, int) {
                        for (std::size_t row = begin; row < end; ++row)
                          tint_row(picture, rays, preview, around.top + int(row), around.left, around.right);
                      });
  }
  for (const EditPreview& preview : previews) draw_edges(picture, rays.camera, preview.bounds, preview.rgb);
}

}  // namespace gigabake
