#include <algorithm>
#include <utility>
#include <vector>

#include "kernels/cuda/device/memory.cuh"
#include "kernels/cuda/device/stream.cuh"
#include "query/first_hit/device_copy.cuh"
#include "query/first_hit/query_device.h"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 128;
constexpr std::size_t rays_per_launch = std::size_t(1) << 18;

__global__ void __launch_bounds__(threads)
    cast_queries(const __grid_constant__ QueryCells cells, const __grid_constant__ QueryLevels levels,
                 const __grid_constant__ VoxelBox window, const QueryRay* rays, std::uint32_t count,
                 QueryTraversal* walks) {
  __shared__ std::uint32_t slots[first_hit_stack * threads];
  const std::uint32_t i = blockIdx.x * threads + threadIdx.x;
  if (i >= count) return;
  const QueryRay ray = rays[i];
  QueryTraversal walk = start_march(ray, levels, window);
  advance_walk(ray, levels, cells, FirstHitSlots<threads>{slots + threadIdx.x}, walk);
  walks[i] = walk;
}

constexpr const char* copy_call = "cudaMemcpyAsync (queries, to the device)";

}  // namespace

class CudaQuery::Impl {
 public:
  Impl(int device, const QueryCells& cells, const QueryLevels& levels, const VoxelBox& window,
       std::uint64_t device_bytes)
      : device_(device), stream_(device), cells_(cells), levels_(levels), window_(window) {
    heap_.limit_to(device_bytes);
    own(cells_.layout.cells, layout_cells_);
    own(cells_.layout.column_key, column_key_);
    own(cells_.layout.column_first, column_first_);
    own(cells_.entries, entries_);
    trees_ = DeviceArray<ShardTree>(heap_, cells.entries.size);
    cells_.trees = {trees_.data(), trees_.size()};
    rays_ = DeviceArray<QueryRay>(heap_, rays_per_launch);
    walks_ = DeviceArray<QueryTraversal>(heap_, rays_per_launch);
    wait();
  }

  void add_tree(std::uint32_t cell, std::uint32_t shard, const ShardTree& tree) {
    check_cuda(cudaSetDevice(device_), "cudaSetDevice");
    ShardTree resident = tree;
    DeviceArray<FirstHitNode> nodes;
    DeviceArray<VoxelAttributes> attributes;
    own(resident.tree.nodes, nodes);
    own(resident.attributes, attributes);
    DeviceArray<std::uint16_t> classes;
    own(resident.classes, classes);
    const QueryCells::Entry entry{shard, QueryCells::State::resident};
    copy_to_device(trees_.data() + cell, Span<const ShardTree>{&resident, 1}, stream_.handle, copy_call);
    copy_to_device(entries_.data() + cell, Span<const QueryCells::Entry>{&entry, 1}, stream_.handle, copy_call);
    wait();
    nodes_.push_back(std::move(nodes));
    attributes_.push_back(std::move(attributes));
    classes_.push_back(std::move(classes));
  }

  void cast(Span<const QueryRay> rays, Span<QueryTraversal> walks) {
    check_cuda(cudaSetDevice(device_), "cudaSetDevice");
    for (std::size_t first = 0; first < rays.size; first += rays_per_launch) {
      const std::size_t count = std::min(rays_per_launch, rays.size - first);
      copy_to_device(rays_.data(), Span<const QueryRay>{rays.data + first, count}, stream_.handle, copy_call);
      cast_queries<<<grid_of(count, threads), threads, 0, stream_.handle>>>(cells_, levels_, window_, rays_.data(),
                                                                            std::uint32_t(count), walks_.data());
      check_launch("cast_queries");
      check_cuda(cudaMemcpyAsync(walks.data + first, walks_.data(), count * sizeof(QueryTraversal),
                                 cudaMemcpyDeviceToHost, stream_.handle),
                 "cudaMemcpyAsync (queries, to the host)");
    }
    wait();
  }

  std::uint64_t device_bytes() const { return heap_.live(); }

 private:
  void wait() const { check_cuda(cudaStreamSynchronize(stream_.handle), "cudaStreamSynchronize (queries)"); }

  /// Copies the array to the device and lets the span refer to the copy.
  template <class T>
  void own(Span<const T>& span, DeviceArray<T>& array) {
    array = DeviceArray<T>(heap_, span.size);
    copy_to_device(array.data(), span, stream_.handle, copy_call);
    span.data = array.data();
  }

  int device_;
  Stream stream_;
  DeviceMemoryStats memory_stats_;
  DeviceHeap heap_{stream_.handle, memory_stats_};
  QueryCells cells_;  ///< its spans refer to the device's arrays
  QueryLevels levels_;
  VoxelBox window_;
  DeviceArray<CastCell> layout_cells_;
  DeviceArray<std::uint64_t> column_key_;
  DeviceArray<std::uint32_t> column_first_;
  DeviceArray<QueryCells::Entry> entries_;
  DeviceArray<ShardTree> trees_;
  std::vector<DeviceArray<FirstHitNode>> nodes_;
  std::vector<DeviceArray<VoxelAttributes>> attributes_;
  std::vector<DeviceArray<std::uint16_t>> classes_;
  DeviceArray<QueryRay> rays_;
  DeviceArray<QueryTraversal> walks_;
};

CudaQuery::CudaQuery(int device, const QueryCells& cells, const QueryLevels& levels, const VoxelBox& window,
                     std::uint64_t device_bytes)
    : impl_(std::make_unique<Impl>(device, cells, levels, window, device_bytes)) {}
CudaQuery::~CudaQuery() = default;
void CudaQuery::add_tree(std::uint32_t cell, std::uint32_t shard, const ShardTree& tree) {
  impl_->add_tree(cell, shard, tree);
}
void CudaQuery::cast(Span<const QueryRay> rays, Span<QueryTraversal> walks) { impl_->cast(rays, walks); }
std::uint64_t CudaQuery::device_bytes() const { return impl_->device_bytes(); }

}  // namespace gigabake::kernels
