#include "viewer/live/scene_editor.h"

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

}  // namespace

void draw_previews(Picture& picture, const PictureRays& rays, const EditPreviews& previews) {
  for (int y = 0; y < picture.height && !previews.empty(); ++y)
    for (int x = 0; x < picture.width; ++x) {
      const std::size_t pixel = std::size_t(y) * std::size_t(picture.width) + std::size_t(x);
      const float depth = picture.depth[pixel];
      if (!(depth > 0 && depth < kernels::CastRay::no_depth)) continue;
      const Vec3i64 voxel = voxel_at(rays.camera, x, y, depth);
      for (const EditPreview& preview : previews)
        if (contains(preview.bounds, voxel) && preview.selects(voxel)) tint(&picture.rgba[4 * pixel], preview.rgb);
    }
  for (const EditPreview& preview : previews) draw_edges(picture, rays.camera, preview.bounds, preview.rgb);
}

}  // namespace gigabake
