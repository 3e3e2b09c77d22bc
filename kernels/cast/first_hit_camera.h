/// Pictures of first hits: a camera's rays, and beams that say for a tile of pixels how far there is nothing to meet.
///
/// A beam is the ray through the middle of a tile, walking through a shell (first_hit_tree.h). The tile's other rays
/// keep within the shell's reach of it up to a limit; until the beam meets the shell, none of them can meet a voxel.
#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/cast/first_hit.h"

namespace gigabake::kernels {

/// Space   Lod-0 voxels of the lattice. Row 0 is the upper one.
struct FirstHitCamera {
  double eye[3] = {};                    ///< where the middle of the picture looks from
  float across[3] = {}, upward[3] = {};  ///< from there to where its right and its upper edge look from; central: 0
  float forward[3] = {};                 ///< where the middle looks, unit
  float right[3] = {}, up[3] = {};       ///< what is added for the right and for the upper edge; parallel: 0
  std::int32_t width = 0, height = 0;    ///< pixels
  float per_column = 0, per_row = 0;     ///< 2 / width, 2 / height
};

/// Through x, y in pixels from the picture's upper left corner. Its length is 1 to 2^-22.
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
  std::int32_t tile = 0;               ///< pixels, an edge of a tile; 0: beams are not worth their time
  std::int32_t tile_bits = 0;          ///< log2 of tile
  std::int32_t columns = 0, rows = 0;  ///< of tiles
  float limit = 0;                     ///< distance up to which a tile's rays keep together
  float slack = 0;                     ///< what rounding may shorten a distance by
};

/// The distance before which the tile's rays meet nothing.
template <class Stack>
GB_HD float beam_start(const FirstHitBeams& beams, const FirstHitCamera& camera, int column, int row, Stack stack) {
  const float middle = 0.5f * float(beams.tile);
  FirstHitRay ray = camera_ray(camera, float(column * beams.tile) + middle, float(row * beams.tile) + middle);
  ray.end = beams.limit;
  const FirstHit hit = first_hit(beams.shell, ray, 0, stack);
  return larger(smaller(hit.distance, beams.limit) - beams.slack, 0);
}

/// Pixel (x, y)'s ray, which meets nothing before `start`.
template <class Stack>
GB_HD FirstHit pixel_hit(const FirstHitTree& tree, const FirstHitCamera& camera, int x, int y, float start,
                         Stack stack) {
  return first_hit(tree, camera_ray(camera, float(x) + 0.5f, float(y) + 0.5f), start, stack);
}

}  // namespace gigabake::kernels
