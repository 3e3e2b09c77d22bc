/// Casting rays through a paged scene, front to back.
///
/// A ray walks a fixed sequence of points: on level l they lie half a voxel of l apart, and l is the level whose voxels
/// are at most a pixel wide at that distance. Which points are looked at, and what is seen there, depends on the ray
/// and the voxels alone; empty space is only stepped over. So neither the cells, nor which pages are here, nor the
/// order of rays shows in the picture.
///
/// Space   Lod-0 voxels of the scene's lattice; distances in them too.
/// Exact   IEEE float and double, no transcendental functions: host and device return the same bits.
/// Source  Crassin et al. 2009, "GigaVoxels" (rays that ask for what they miss).
#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/cast_locate.h"
#include "kernels/cast_sample.h"
#include "kernels/cast_scene.h"
#include "kernels/types.h"

namespace gigabake::kernels {

class CpuPolicy;

/// Light that reaches the eye from the air before the surface: 1 - e^(-distance · per_voxel) of it.
struct CastHaze {
  float rgb[3] = {0, 0, 0};
  float per_voxel = 0;
};

struct CastCamera {
  double eye[3] = {};
  double forward[3] = {};            ///< unit
  double right[3] = {}, up[3] = {};  ///< from the picture's middle to its edge, where forward ends
  std::int32_t width = 0, height = 0;
  double lod1_depth = 0;  ///< depth (along forward) from which voxels of lod 1 are at most a pixel wide; > 0
  CastHaze haze;
};

/// A ray on its way. What was not finished goes on from here.
struct CastRay {
  float rgb[3] = {0, 0, 0};  ///< linear, premultiplied
  float transmittance = 1;
  std::int64_t step = 0;  ///< next point of the level
  std::int32_t lod = -1;  ///< -1: finished
  std::uint32_t missing = no_page;
};

/// A pixel's line of sight.
struct CastLine {
  double origin[3], direction[3];  ///< unit
  double inverse[3];               ///< 1 / direction
  double enter, leave;             ///< distances between which the scene's box lies; enter > leave: misses it
  double lod1_distance;
};

/// e^-x for x ≥ 0 to 2e-5 relative; less than 2e-7 beyond 16.
GB_HD float exp_minus(float x) {
  const float y = (x < 16 ? x : 16) * (-1.0f / 64);
  float e = 1 + y * (1 + y * (0.5f + y * (1.0f / 6 + y * (1.0f / 24 + y * (1.0f / 120)))));
  for (int i = 0; i < 6; ++i) e *= e;
  return e;
}

GB_HD void clip_to_box(CastLine& line, int axis, double low, double high) {
  const double o = line.origin[axis], d = line.direction[axis];
  if (d == 0) {
    if (o < low || o > high) line.leave = -1;
    return;
  }
  const double a = (low - o) * line.inverse[axis], b = (high - o) * line.inverse[axis];
  const double nearer = a < b ? a : b, farther = a < b ? b : a;
  if (nearer > line.enter) line.enter = nearer;
  if (farther < line.leave) line.leave = farther;
}

/// Through the middle of pixel (x, y); row 0 is the upper one.
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
    line.direction[a] /= length;
    line.inverse[a] = 1 / line.direction[a];
    clip_to_box(line, a, scene.min[a] - border, scene.max[a] + border);
  }
  return line;
}

GB_HD double lod_start(const CastLine& line, int lod) {
  return lod == 0 ? 0 : line.lod1_distance * double(std::int64_t(1) << (lod - 1));
}

GB_HD double step_length(int lod) { return 0.5 * double(std::int64_t(1) << lod); }

GB_HD CastRay start_ray(const CastScene& scene, const CastLine& line) {
  CastRay ray;
  if (!(line.enter <= line.leave)) return ray;
  ray.lod = 0;
  while (ray.lod + 1 < scene.lods && line.enter >= lod_start(line, ray.lod + 1)) ++ray.lod;
  const double step = std::floor((line.enter - lod_start(line, ray.lod)) / step_length(ray.lod) - 0.5);
  ray.step = step > 0 ? std::int64_t(step) : 0;
  return ray;
}

/// The part of an empty box where the field is zero: what lies beyond a side reaches half a voxel in.
struct EmptyBox {
  double min[3], max[3];

  GB_HD bool contains(const double p[3]) const {
    return p[0] >= min[0] && p[0] <= max[0] && p[1] >= min[1] && p[1] <= max[1] && p[2] >= min[2] && p[2] <= max[2];
  }
};

GB_HD EmptyBox without_rim(const CastPlace& place, int lod) {
  const double rim = 0.5 * double(std::int64_t(1) << lod);
  EmptyBox box;
  for (int a = 0; a < 3; ++a) {
    box.min[a] = double(place.min[a]) + rim;
    box.max[a] = double(place.max[a]) - rim;
  }
  return box;
}

/// The same for an empty box together with its empty neighbour beyond the one side that p is near.
GB_HD bool find_joint_box(const CastScene& scene, int lod, const double p[3], const std::int64_t v[3],
                          const CastPlace& here, CastPlace& there, EmptyBox& box) {
  const double rim = 0.5 * double(std::int64_t(1) << lod);
  std::int64_t beyond[3] = {v[0], v[1], v[2]};
  int axis = -1;
  for (int a = 0; a < 3; ++a) {
    const bool low = p[a]<double(here.min[a]) + rim, high = p[a]> double(here.max[a]) - rim;
    if (!low && !high) continue;
    if (axis >= 0) return false;
    axis = a;
    beyond[a] = low ? here.min[a] - 1 : here.max[a];
  }
  if (!there.contains(beyond)) there = locate(scene, lod, beyond, here);
  if (!there.empty() || there.missing != no_page) return false;
  for (int a = 0; a < 3; ++a) {
    const bool joined_low = a == axis ? here.min[a] > there.min[a] : here.min[a] < there.min[a];
    const bool joined_high = a == axis ? here.max[a] < there.max[a] : here.max[a] > there.max[a];
    box.min[a] = double(joined_low ? there.min[a] : here.min[a]) + rim;
    box.max[a] = double(joined_high ? there.max[a] : here.max[a]) - rim;
  }
  return box.contains(p);
}

/// Half of a brick along each axis, around p, where the field is zero: the voxels of that half and those next to it in
/// the brick are not there. False where some are, or where p lies in the brick's rim.
GB_HD bool find_empty_octant(const CastPlace& place, int lod, const double p[3], EmptyBox& box) {
  const double edge = double(std::int64_t(1) << lod), per_edge = 1 / edge;
  int first[3], last[3];
  for (int a = 0; a < 3; ++a) {
    const double between_centres = (p[a] - double(place.min[a])) * per_edge - 0.5;
    if (between_centres < 0 || between_centres > brick_edge - 1) return false;
    first[a] = between_centres < 4 ? 0 : 4;
    last[a] = between_centres < 4 ? 4 : 7;
    box.min[a] = double(place.min[a]) + (first[a] + 0.5) * edge;
    box.max[a] = double(place.min[a]) + (last[a] + 0.5) * edge;
  }
  const std::uint64_t in_row = first[0] == 0 ? 0x1f : 0xf0;
  const std::uint64_t rows = first[1] == 0 ? 0x0000000101010101 : 0x0101010100000000;
  std::uint64_t seen = 0;
  for (int z = first[2]; z <= last[2]; ++z) seen |= place.brick->mask[z];
  return (seen & in_row * rows) == 0;
}

/// The first point that may lie outside of the box. A millionth of a step guards against rounding: a point too many
/// costs time, a point too few would show.
GB_HD std::int64_t step_beyond(const CastLine& line, const EmptyBox& box, const CastRay& ray) {
  double leave = line.leave + step_length(ray.lod);
  for (int a = 0; a < 3; ++a) {
    if (line.direction[a] == 0) continue;
    const double side = line.direction[a] > 0 ? box.max[a] : box.min[a];
    const double beyond_side = (side - line.origin[a]) * line.inverse[a];
    if (beyond_side < leave) leave = beyond_side;
  }
  const double step = std::ceil((leave - lod_start(line, ray.lod)) / step_length(ray.lod) - (0.5 + 1e-6));
  return step > double(ray.step + 1) ? std::int64_t(step) : ray.step + 1;
}

GB_HD void composite(const CastSample& s, double distance, const CastHaze& haze, CastRay& ray) {
  const float seen = exp_minus(float(distance) * haze.per_voxel);
  const float opacity = 1 - exp_minus(s.c[3] * (0.5f * opaque_extinction));  // points lie half a voxel apart
  const float weight = ray.transmittance * opacity, radiance = 2 / s.c[3];
  for (int k = 0; k < 3; ++k) ray.rgb[k] += weight * (s.c[k] * radiance * seen + haze.rgb[k] * (1 - seen));
  ray.transmittance *= 1 - opacity;
}

/// What is still to come would not show: the ray ends as if the last surface were opaque.
GB_HD void finish_opaque(CastRay& ray) {
  const float scale = 1 / (1 - ray.transmittance);
  for (float& channel : ray.rgb) channel *= scale;
  ray.transmittance = 0;
  ray.lod = -1;
}

/// Where a ray is, and where it just was or is about to be: neighbouring points share them.
struct CastPlaces {
  CastPlace here, there;

  GB_HD void move_to(const CastScene& scene, int lod, const std::int64_t v[3]) {
    if (here.contains(v)) return;
    const CastPlace left = here;
    here = there.contains(v) ? there : locate(scene, lod, v, left);
    there = left;
  }
};

/// Looks at one point and goes on to the next one worth looking at. False: a page is missing.
GB_HD bool step_ray(const CastScene& scene, const CastCamera& camera, const CastLine& line, double distance,
                    CastPlaces& places, CastRay& ray) {
  double p[3];
  std::int64_t v[3];
  for (int a = 0; a < 3; ++a) {
    p[a] = line.origin[a] + line.direction[a] * distance;
    v[a] = std::int64_t(std::floor(p[a]));
  }
  places.move_to(scene, ray.lod, v);
  ray.missing = places.here.missing;
  if (ray.missing != no_page) return false;
  EmptyBox box;
  if (places.here.empty()) {
    box = without_rim(places.here, ray.lod);
    if (box.contains(p) || find_joint_box(scene, ray.lod, p, v, places.here, places.there, box)) {
      ray.step = step_beyond(line, box, ray);
      return true;
    }
  }
  CastSample sample;
  ray.missing = sample_field(scene, ray.lod, p, places.here, places.there, sample);
  if (ray.missing != no_page) return false;
  if (sample.c[3] > 0) {
    composite(sample, distance, camera.haze, ray);
    if (ray.transmittance < 1.0f / 1024) finish_opaque(ray);
  } else if (places.here.brick != nullptr && find_empty_octant(places.here, ray.lod, p, box)) {
    ray.step = step_beyond(line, box, ray);
    return true;
  }
  ++ray.step;
  return true;
}

/// Goes on until the ray is finished (lod = -1) or a page is missing.
GB_HD void cast_ray(const CastScene& scene, const CastCamera& camera, const CastLine& line, CastRay& ray) {
  CastPlaces places;
  while (ray.lod >= 0) {
    const double distance = lod_start(line, ray.lod) + (double(ray.step) + 0.5) * step_length(ray.lod);
    if (distance > line.leave) {
      ray.lod = -1;
    } else if (ray.lod + 1 < scene.lods && distance >= lod_start(line, ray.lod + 1)) {
      ++ray.lod;
      ray.step = 0;
      places = CastPlaces();
    } else if (!step_ray(scene, camera, line, distance, places, ray)) {
      return;
    }
  }
}

/// A rectangle of the picture: ray i is pixel (x + i mod width, y + i div width).
struct CastTile {
  int x = 0, y = 0, width = 0, height = 0;
};

/// Starts every ray of the tile.
void start_rays(const CastScene& scene, const CastCamera& camera, const CastTile& tile, Span<CastRay> rays,
                const CpuPolicy& policy);

/// Casts every ray of the tile that is not finished.
void cast_rays(const CastScene& scene, const CastCamera& camera, const CastTile& tile, Span<CastRay> rays,
               const CpuPolicy& policy);

}  // namespace gigabake::kernels
