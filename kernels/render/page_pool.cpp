#include "kernels/render/page_pool.h"

#include <algorithm>

namespace gigabake::kernels {
namespace {

/// Returns an array without values; null if the pool does not have the column.
template <class T>
std::unique_ptr<T[]> column(bool exists, std::size_t voxels, std::size_t per_voxel) {
  return std::unique_ptr<T[]>(exists ? new T[voxels * per_voxel] : nullptr);
}

/// Copies the values of `count` voxels; does nothing if the page or the pool does not have the column.
template <class T>
void copy_column(const T* from, T* to, const PageUpload& page, std::size_t per_voxel) {
  if (from != nullptr && to != nullptr)
    std::copy_n(from, per_voxel * page.count, to + per_voxel * std::size_t(page.place.first));
}

}  // namespace

std::uint64_t PagePoolSize::bytes_per_voxel() const {
  return 4 + (has_normals ? 2 : 0) + (has_directional_coverage ? directional_coverage_bytes : 0) +
         (has_classes ? sizeof(VoxelClass) : 0);
}

PagePool::PagePool(const PagePoolSize& size)
    : rgba_(column<std::uint8_t>(size.voxels != 0, size.voxels, 4)),
      directional_coverage_(
          column<std::uint8_t>(size.has_directional_coverage, size.voxels, directional_coverage_bytes)),
      normal_(column<std::int8_t>(size.has_normals, size.voxels, 2)),
      voxel_class_(column<VoxelClass>(size.has_classes, size.voxels, 1)) {}

void PagePool::put(const std::vector<PageUpload>& pages, const ThreadPool& pool) {
  pool.parallel_for(pages.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      const PageUpload& page = pages[i];
      copy_column(page.voxels.rgba, rgba_.get(), page, 4);
      copy_column(page.voxels.normal, normal_.get(), page, 2);
      copy_column(page.voxels.directional_coverage, directional_coverage_.get(), page, directional_coverage_bytes);
      copy_column(page.voxels.voxel_class, voxel_class_.get(), page, 1);
    }
  });
}

StoredVoxels PagePool::voxels() const {
  return {rgba_.get(), normal_.get(), directional_coverage_.get(), voxel_class_.get()};
}

}  // namespace gigabake::kernels
