/// The CUDA backend of queries: casts rays through the cells whose trees are on the device.
///
/// In a build without CUDA the constructor throws; cuda_devices() (kernels/cuda/baker.h) gives the reason.
#pragma once

#include <cstdint>
#include <memory>

#include "core/base/error.h"
#include "query/first_hit/query_cells.h"

namespace gigabake::kernels {

/// Rays, cells and trees on one device. Not thread-safe.
/// Errors  CudaFailure, from every member.
class CudaQuery {
 public:
  /// Copies the cells' layout and entries to the device. No tree is resident initially. `window` is the bounding box of
  /// all cells. `device_bytes` is the max memory to use on the device.
  /// Range   device: an ordinal that cuda_devices() returned.
  CudaQuery(int device, const QueryCells& cells, const QueryLevels& levels, const VoxelBox& window,
            std::uint64_t device_bytes);
  ~CudaQuery();
  CudaQuery(const CudaQuery&) = delete;
  CudaQuery& operator=(const CudaQuery&) = delete;

  /// Copies the tree of a cell to the device. `shard` is the shard number that hits report.
  /// Errors  DeviceFull: the tree does not fit. The device's other trees stay usable.
  void add_tree(std::uint32_t cell, std::uint32_t shard, const ShardTree& tree);

  /// Casts each ray until it is finished or pauses at a tree that is not resident. Writes one traversal per ray.
  /// Exact   The same bits as start_march() and advance_walk() on the host.
  void cast(Span<const QueryRay> rays, Span<QueryTraversal> walks);

  std::uint64_t device_bytes() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gigabake::kernels
