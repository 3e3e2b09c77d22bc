/// Images of first hits: a camera's rays, and beams that yield the empty distance in front of a tile of pixels.
///
/// A beam is the ray through the centre of a tile, cast through a shell (first_hit_tree.h). Up to a limit, the tile's
/// rays stay within the shell's reach of the beam. Until the beam hits the shell, none of these rays can hit a voxel.
#pragma once

#include <cmath>
#include <cstdint>

#include "query/first_hit/first_hit.h"

namespace gigabake::kernels {

/// A camera with perspective or parallel rays. Row 0 is the top row.
/// Space   Lod-0 voxels of the lattice.
struct FirstHitCamera {
  double eye[3] = {};                    ///< origin of the ray through the image's centre
  float across[3] = {}, upward[3] = {};  ///< offsets of the origin at the right and upper edges; perspective: 0
  float forward[3] = {};                 ///< direction at the image's centre, unit vector
  float right[3] = {}, up[3] = {};       ///< offsets of the direction at the right and upper edges; parallel: 0
  std::int32_t width = 0, height = 0;    ///< pixels
  float per_column = 0, per_row = 0;     ///< 2 / width, 2 / height
};

/// Returns the ray through point (x, y) of the image, in pixels from its upper left corner. The direction's length is 1
/// with an error of up to 2^-22.
GB_HD FirstHitRay camera_ray(const FirstHitCamera& camera, float x, float y) {
  const float sx = std::fma(x, camera.per_column, -1.0f), sy = std::fma(y, -camera.per_row, 1.0f);
  FirstHitRay ray;
  float squared = 0;
  for (int a = 0; a < 3; ++a) {
    ray.origin[a] = camera.eye[a] + double(std::fma(camera.upward[a], sy, camera.across[a] * sx));
    ray.direction[a] = std::fma(camera.up[a], sy, std::fma(camera.right[a], sx, camera.forward[a]));
    squared = std::fma(ray.direction[a], ray.direction[a], squared);
  }
  const float per_length = 1 / std::sqrt(squared);
  for (int a = 0; a < 3; ++a) ray.direction[a] *= per_length;
  return ray;
}

struct FirstHitBeams {
  FirstHitTree shell;
  std::int32_t tile = 0;               ///< edge of a tile in pixels; 0: no beams, because they would not save time
  std::int32_t tile_bits = 0;          ///< log2 of tile
  std::int32_t columns = 0, rows = 0;  ///< numbers of tiles
  float limit = 0;                     ///< distance up to which a tile's rays stay within the shell's reach
  float slack = 0;                     ///< max amount by which rounding may shorten a distance
};

/// Returns a distance before which none of the tile's rays hits a voxel.
template <class Stack>
GB_HD float beam_start(const FirstHitBeams& beams, const FirstHitCamera& camera, int column, int row, Stack stack) {
  const float middle = 0.5f * float(beams.tile);
  FirstHitRay ray = camera_ray(camera, float(column * beams.tile) + middle, float(row * beams.tile) + middle);
  ray.end = beams.limit;
  const FirstHit hit = first_hit(beams.shell, ray, 0, stack);
  return larger(smaller(hit.distance, beams.limit) - beams.slack, 0);
}

/// Casts the ray of pixel (x, y) from distance `start` on.
/// Range   No voxel lies on the ray before `start` (beam_start()).
template <class Stack>
GB_HD FirstHit pixel_hit(const FirstHitTree& tree, const FirstHitCamera& camera, int x, int y, float start,
                         Stack stack) {
  return first_hit(tree, camera_ray(camera, float(x) + 0.5f, float(y) + 0.5f), start, stack);
}

}  // namespace gigabake::kernels
