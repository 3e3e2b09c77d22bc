/// Mapping of a tile's pixels to threads: a warp covers 8×4 pixels, because neighbours need the same bricks.
#pragma once

#include "kernels/marching/cast_ray.h"

namespace gigabake::kernels {

inline constexpr int tile_block_width = 16, tile_block_height = 8;  ///< pixels
inline constexpr unsigned tile_threads = tile_block_width * tile_block_height;

/// Sets x and y to this thread's pixel in the tile; returns false if the thread has no pixel.
__device__ inline bool pixel_of_thread(const CastTile& tile, unsigned block, int& x, int& y) {
  const int across = (tile.width + tile_block_width - 1) / tile_block_width;
  const int warp = int(threadIdx.x) / 32, lane = int(threadIdx.x) % 32;
  x = int(block) % across * tile_block_width + warp % 2 * 8 + lane % 8;
  y = int(block) / across * tile_block_height + warp / 2 * 4 + lane / 8;
  return x < tile.width && y < tile.height;
}

__device__ inline bool pixel_of_thread(const CastTile& tile, int& x, int& y) {
  return pixel_of_thread(tile, blockIdx.x, x, y);
}

inline unsigned grid_of_tile(const CastTile& tile) {
  return unsigned((tile.width + tile_block_width - 1) / tile_block_width) *
         unsigned((tile.height + tile_block_height - 1) / tile_block_height);
}

}  // namespace gigabake::kernels
