/// A pixel's line of sight through a scene.
///
/// Space   Coordinates and distances are lod-0 voxels of the scene's lattice.
/// Exact   IEEE double: host and device return the same bits.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/marching/cast_camera.h"
#include "kernels/marching/scene.h"

namespace gigabake::kernels {

/// A pixel's line of sight, clipped to the scene's box.
struct CastLine {
  Vec3d origin, direction;    ///< direction: unit length
  Vec3<float> inv_direction;  ///< 1 / |direction| per axis, at most 1e20
  double enter, leave;  ///< distances at which the line enters and leaves the box; enter > leave if it misses the box
  double lod1_distance;
};

/// Sets the direction's component on one axis. `d` is a component of a unit vector.
GB_HD void set_direction(CastLine& line, int axis, double d) {
  const float across = float(d < 0 ? -d : d);
  line.direction[axis] = d;
  line.inv_direction[axis] = across > 1e-20f ? 1 / across : 1e20f;
}

/// Returns all bits set if the line runs towards lower coordinates on the axis, otherwise 0.
GB_HD std::uint32_t backward(const CastLine& line, int axis) {
  return std::uint32_t(std::bit_cast<std::int64_t>(line.direction[axis]) >> 63);
}

GB_HD void clip_to_box(CastLine& line, int axis, double low, double high) {
  const double o = line.origin[axis], d = line.direction[axis];
  if (d == 0) {
    if (o < low || o > high) line.leave = -1;
    return;
  }
  const double inverse = 1 / d, a = (low - o) * inverse, b = (high - o) * inverse;
  const double nearer = a < b ? a : b, farther = a < b ? b : a;
  if (nearer > line.enter) line.enter = nearer;
  if (farther < line.leave) line.leave = farther;
}

GB_HD void clip_to_plane(CastLine& line, const CastClip& clip) {
  if (clip.normal[0] == 0 && clip.normal[1] == 0 && clip.normal[2] == 0 && clip.offset <= 0) return;
  double above = -clip.offset, slope = 0;
  for (int a = 0; a < 3; ++a) {
    above += clip.normal[a] * line.origin[a];
    slope += clip.normal[a] * line.direction[a];
  }
  const double met = -above / slope;
  if (slope == 0 && above < 0) line.leave = -1;
  if (slope > 0 && met > line.enter) line.enter = met;
  if (slope < 0 && met < line.leave) line.leave = met;
}

GB_HD double larger_of(double a, double b) { return a > b ? a : b; }
GB_HD double smaller_of(double a, double b) { return a < b ? a : b; }

/// Returns the line through the centre of pixel (x, y); row 0 is the top row.
GB_HD CastLine line_of_sight(const CastScene& scene, const CastCamera& camera, int x, int y) {
  const double sx = (2 * (x + 0.5)) / camera.width - 1, sy = 1 - (2 * (y + 0.5)) / camera.height;
  CastLine line;
  double squared = 0;
  for (int a = 0; a < 3; ++a) {
    line.origin[a] = camera.eye[a];
    line.direction[a] = camera.forward[a] + (camera.right[a] * sx + camera.up[a] * sy);
    squared += line.direction[a] * line.direction[a];
  }
  const double length = std::sqrt(squared), border = double(std::int64_t(1) << scene.lods);
  line.enter = 0;
  line.leave = double(far_voxel);
  line.lod1_distance = camera.lod1_depth * length;
  for (int a = 0; a < 3; ++a) {
    set_direction(line, a, line.direction[a] * (1 / length));
    clip_to_box(line, a, larger_of(scene.min[a] - border, camera.clip.min[a]),
                smaller_of(scene.max[a] + border, camera.clip.max[a]));
  }
  clip_to_plane(line, camera.clip);
  if (camera.polygons.distance != nullptr) {
    const double distance =
        double(camera.polygons.distance[std::size_t(y) * std::size_t(camera.width) + std::size_t(x)]);
    if (distance < line.leave) line.leave = distance;
  }
  return line;
}

}  // namespace gigabake::kernels
