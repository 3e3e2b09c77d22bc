/// The page pool of a caster: columns of stored voxels, from which the caster copies the runs of bricks.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/light/stored_voxel.h"

namespace gigabake::kernels {

/// The indices of pages in a page pool are multiples of this value, so that all columns begin at whole words.
inline constexpr std::uint32_t page_alignment = 4;

/// The size of a page pool and the channels of its voxels.
struct PagePoolSize {
  std::uint32_t voxels = 0;  ///< a multiple of page_alignment; 0: no pool, and bricks have no runs
  bool has_normals = false, has_directional_coverage = false, has_classes = false;
  StoredVoxelShading shading;  ///< of all bricks; with tables of the host, which the owner of the caster keeps

  std::uint64_t bytes_per_voxel() const;
  std::uint64_t bytes() const { return voxels * bytes_per_voxel(); }
};

/// The voxels of a page in the host's memory, and their place in the pool.
/// Range   place.first is a multiple of page_alignment.
struct PageUpload {
  StoredVoxels voxels;
  std::uint32_t count = 0;
  PooledPage place;
};

/// A page pool in the host's memory.
class PagePool {
 public:
  explicit PagePool(const PagePoolSize& size);

  /// Copies pages on the threads of `pool`. Pages do not overlap.
  void put(const std::vector<PageUpload>& pages, const ThreadPool& pool);
  StoredVoxels voxels() const;

 private:
  // The arrays are not initialised, because untouched pages cost no memory.
  std::unique_ptr<std::uint8_t[]> rgba_, directional_coverage_;
  std::unique_ptr<std::int8_t[]> normal_;
  std::unique_ptr<VoxelClass[]> voxel_class_;
};

}  // namespace gigabake::kernels
