/// How the pixels of a tile are spread over threads: a warp is 8×4 of them, since neighbours need the same bricks.
#pragma once

#include "kernels/cast/cast.h"

namespace gigabake::kernels {

inline constexpr int tile_block_width = 16, tile_block_height = 8;  ///< pixels
inline constexpr unsigned tile_threads = tile_block_width * tile_block_height;

GB_HD std::uint32_t blocks_of(const CastTile& tile) {
  return std::uint32_t((tile.width + tile_block_width - 1) / tile_block_width) *
         std::uint32_t((tile.height + tile_block_height - 1) / tile_block_height);
}

/// Pixels that blocks have, those beyond the tile too.
GB_HD std::uint32_t turns_of(const CastTile& tile) { return tile_threads * blocks_of(tile); }

/// Pixel `turn` of the tile, block by block and in these 8×4 after 8×4; false outside of it.
GB_HD bool pixel_of_turn(const CastTile& tile, std::uint32_t turn, int& x, int& y) {
  const int across = (tile.width + tile_block_width - 1) / tile_block_width;
  const int block = int(turn / tile_threads), warp = int(turn % tile_threads) / 32, lane = int(turn % 32);
  x = block % across * tile_block_width + warp % 2 * 8 + lane % 8;
  y = block / across * tile_block_height + warp / 2 * 4 + lane / 8;
  return x < tile.width && y < tile.height;
}

/// The pixel of this thread.
__device__ inline bool pixel_of_thread(const CastTile& tile, int& x, int& y) {
  return pixel_of_turn(tile, blockIdx.x * tile_threads + threadIdx.x, x, y);
}

}  // namespace gigabake::kernels
