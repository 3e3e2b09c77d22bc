/// Runs of stored voxels: the list from which a brick is copied out of pages.
///
/// The host finds the stored voxels of a brick. It needs only the masks of pages for this. The columns are read where
/// the brick is built: on the host, or on a device that has a copy of the page (kernels/light/stored_voxel.h).
#pragma once

#include <cstdint>

namespace gigabake::kernels {

/// The max number of pages that one brick is copied from.
inline constexpr int max_brick_pages = 8;

/// Voxels of a row of a slot that also follow each other in a page.
struct VoxelRun {
  std::uint32_t from;   ///< index of the first voxel in its page
  std::uint16_t place;  ///< of the first voxel in the slot: x + 9y + 81z
  std::uint8_t count;   ///< 1 … 8
  std::uint8_t page;    ///< index among the brick's pages
};

/// The place of a page's voxels in a page pool.
struct PooledPage {
  std::uint32_t first = 0;                ///< index of the page's first voxel in the pool
  bool has_directional_coverage = false;  ///< otherwise the pool's bytes of these voxels are not set
  bool has_classes = false;
};

}  // namespace gigabake::kernels
