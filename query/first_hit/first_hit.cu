#include <algorithm>
#include <stdexcept>

#include "kernels/cuda/device/memory.cuh"
#include "kernels/cuda/device/stream.cuh"
#include "query/first_hit/device_copy.cuh"
#include "query/first_hit/first_hit_device.h"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 128;  ///< per block; in an image, a block casts 16×8 pixels and a warp 8×4
constexpr unsigned whole_warp = ~0u;
constexpr int pixels_x = 16, pixels_y = 8;
constexpr int refill_at = 8;  ///< min number of idle rays for which a warp fetches new rays
constexpr int moves_between_refills = 4;
constexpr std::size_t max_rays = std::size_t(1) << 31;

/// The stack of one ray. The stacks of neighbouring rays are interleaved.
using SharedStack = FirstHitSlots<threads>;

struct DeviceResult {
  FirstHit* hits;
  VoxelAttributes* attributes;  ///< null if no attributes are requested
  const VoxelAttributes* of_voxels;

  __device__ void set(std::size_t i, const FirstHit& hit) const {
    hits[i] = hit;
    if (attributes == nullptr) return;
    VoxelAttributes voxel;
    if (hit.attributes_index != no_attributes) voxel = of_voxels[hit.attributes_index];
    attributes[i] = voxel;
  }
};

__global__ void __launch_bounds__(64) cast_beams(const __grid_constant__ FirstHitBeams beams,
                                                 const __grid_constant__ FirstHitCamera camera, float* starts) {
  std::uint32_t slots[first_hit_stack];
  const int column = int(blockIdx.x * 8 + threadIdx.x % 8), row = int(blockIdx.y * 8 + threadIdx.x / 8);
  if (column >= beams.columns || row >= beams.rows) return;
  starts[row * beams.columns + column] = beam_start(beams, camera, column, row, FirstHitSlots<1>{slots});
}

/// Casts the rays of an image. `starts` is null if there are no beams.
__global__ void __launch_bounds__(threads)
    cast_pixels(const __grid_constant__ FirstHitTree tree, const __grid_constant__ FirstHitCamera camera,
                const float* starts, int tile_bits, int columns, DeviceResult result) {
  __shared__ std::uint32_t slots[first_hit_stack * threads];
  const int lane = int(threadIdx.x % 32), warp = int(threadIdx.x / 32);
  const int x = int(blockIdx.x) * pixels_x + warp % 2 * 8 + lane % 8;
  const int y = int(blockIdx.y) * pixels_y + warp / 2 * 4 + lane / 8;
  if (x >= camera.width || y >= camera.height) return;
  const float start = starts == nullptr ? 0 : starts[(y >> tile_bits) * columns + (x >> tile_bits)];
  result.set(std::size_t(y) * std::size_t(camera.width) + std::size_t(x),
             pixel_hit(tree, camera, x, y, start, SharedStack{slots + threadIdx.x}));
}

/// Casts incoherent rays. Each warp has a queue of `per_warp` rays and replaces finished rays while others are
/// traversed.
__global__ void __launch_bounds__(threads) cast_rays(const __grid_constant__ FirstHitTree tree, const FirstHitRay* rays,
                                                     std::uint32_t count, std::uint32_t per_warp, DeviceResult result) {
  __shared__ std::uint32_t slots[first_hit_stack * threads];
  const SharedStack stack{slots + threadIdx.x};
  const std::uint32_t warp = (blockIdx.x * threads + threadIdx.x) / 32, lane = threadIdx.x % 32;
  std::uint32_t next = min(warp * per_warp, count), mine = 0;
  const std::uint32_t end = min(next + per_warp, count);
  FirstHitTraversal walk;
  bool walking = false;
  for (;;) {
    const unsigned idle = __ballot_sync(whole_warp, !walking);
    const int idle_count = __popc(idle);
    if (idle_count == 32 && next == end) return;
    if (idle_count == 32 || (idle_count >= refill_at && next < end)) {
      if (!walking) {
        mine = next + std::uint32_t(__popc(idle & ((1u << lane) - 1)));
        if (mine < end) {
          walking = begin_traversal(tree, rays[mine], 0, walk);
          if (!walking) result.set(mine, {});
        }
      }
      next = min(next + std::uint32_t(idle_count), end);
    }
#pragma unroll 1
    for (int i = 0; i < moves_between_refills; ++i) {
      if (walking) {
        const FirstHitState state = advance(tree, walk, stack);
        walking = state == FirstHitState::walking;
        if (!walking) result.set(mine, state == FirstHitState::met ? met(tree, walk) : FirstHit{});
      }
      __syncwarp();
    }
  }
}

template <class T>
DeviceArray<T> copy_to_device(DeviceHeap& heap, const Span<const T>& host) {
  DeviceArray<T> device(heap, host.size);
  copy_to_device(device.data(), host, heap.stream(), "cudaMemcpyAsync (first hits, to the device)");
  return device;
}

template <class T>
std::vector<T> copy_to_host(const DeviceArray<T>& device, std::size_t size, cudaStream_t stream) {
  std::vector<T> host(size);
  check_cuda(cudaMemcpyAsync(host.data(), device.data(), size * sizeof(T), cudaMemcpyDeviceToHost, stream),
             "cudaMemcpyAsync (first hits, to the host)");
  check_cuda(cudaStreamSynchronize(stream), "cudaStreamSynchronize (first hits)");
  return host;
}

/// Timer for the work that is launched between start() and stop().
class StopWatch {
 public:
  StopWatch() {
    check_cuda(cudaEventCreate(&begin_), "cudaEventCreate");
    check_cuda(cudaEventCreate(&end_), "cudaEventCreate");
  }
  ~StopWatch() {
    cudaEventDestroy(begin_);
    cudaEventDestroy(end_);
  }
  StopWatch(const StopWatch&) = delete;
  StopWatch& operator=(const StopWatch&) = delete;
  void start(cudaStream_t stream) { check_cuda(cudaEventRecord(begin_, stream), "cudaEventRecord"); }
  double stop(cudaStream_t stream) {
    check_cuda(cudaEventRecord(end_, stream), "cudaEventRecord");
    check_cuda(cudaEventSynchronize(end_), "cudaEventSynchronize (first hits)");
    float ms = 0;
    check_cuda(cudaEventElapsedTime(&ms, begin_, end_), "cudaEventElapsedTime");
    return 1e-3 * double(ms);
  }

 private:
  cudaEvent_t begin_ = nullptr, end_ = nullptr;
};

}  // namespace

class CudaFirstHits::Impl {
 public:
  Impl(int device, const FirstHitView& scene) : device_(device), stream_(device), scene_(scene) {
    nodes_ = to_device(scene.tree.nodes, scene_.tree);
    for (int s = 0; s < 2; ++s) shells_[s] = to_device(scene.shells[s].tree.nodes, scene_.shells[s].tree);
    attributes_ = copy_to_device(heap_, scene.attributes);
    check_cuda(cudaDeviceGetAttribute(&multiprocessors_, cudaDevAttrMultiProcessorCount, device),
               "cudaDeviceGetAttribute");
    check_cuda(cudaStreamSynchronize(stream_.handle), "cudaStreamSynchronize (first hits)");
  }

  void upload(Span<const FirstHitRay> rays) {
    if (rays.size > max_rays) throw std::length_error("more than 2^31 rays at once");
    check_cuda(cudaSetDevice(device_), "cudaSetDevice");
    rays_ = copy_to_device(heap_, rays);
    check_cuda(cudaStreamSynchronize(stream_.handle), "cudaStreamSynchronize (rays)");
  }

  double cast(const FirstHitCamera& camera, bool attributes) {
    const FirstHitBeams beams = plan_beams(scene_, camera);
    const DeviceResult result = result_for(std::size_t(camera.width) * std::size_t(camera.height), attributes);
    const std::size_t tiles = std::size_t(beams.columns) * std::size_t(beams.rows);
    if (starts_.size() < tiles) starts_ = DeviceArray<float>(heap_, tiles);
    watch_.start(stream_.handle);
    if (beams.tile != 0) {
      cast_beams<<<dim3(grid_of(unsigned(beams.columns), 8), grid_of(unsigned(beams.rows), 8)), 64, 0,
                   stream_.handle>>>(beams, camera, starts_.data());
      check_launch("cast_beams");
    }
    cast_pixels<<<dim3(grid_of(unsigned(camera.width), pixels_x), grid_of(unsigned(camera.height), pixels_y)), threads,
                  0, stream_.handle>>>(scene_.tree, camera, beams.tile == 0 ? nullptr : starts_.data(), beams.tile_bits,
                                       beams.columns, result);
    check_launch("cast_pixels");
    return watch_.stop(stream_.handle);
  }

  double cast(bool attributes) {
    const DeviceResult result = result_for(rays_.size(), attributes);
    // Long queues keep warps full, but every multiprocessor needs enough warps.
    const std::size_t share = rays_.size() / std::size_t(multiprocessors_ * 32) / 32 * 32;
    const std::size_t per_warp = std::clamp(share, std::size_t(32), std::size_t(256));
    watch_.start(stream_.handle);
    cast_rays<<<grid_of((rays_.size() + per_warp - 1) / per_warp * 32, threads), threads, 0, stream_.handle>>>(
        scene_.tree, rays_.data(), std::uint32_t(rays_.size()), std::uint32_t(per_warp), result);
    check_launch("cast_rays");
    return watch_.stop(stream_.handle);
  }

  std::vector<FirstHit> hits() const { return copy_to_host(hits_, count_, stream_.handle); }
  std::vector<VoxelAttributes> attributes() const {
    return copy_to_host(hit_attributes_, has_attributes_ ? count_ : 0, stream_.handle);
  }
  std::uint64_t device_bytes() const {
    return nodes_.bytes() + shells_[0].bytes() + shells_[1].bytes() + attributes_.bytes();
  }

 private:
  DeviceArray<FirstHitNode> to_device(const Span<const FirstHitNode>& nodes, FirstHitTree& tree) {
    DeviceArray<FirstHitNode> device = copy_to_device(heap_, nodes);
    tree.nodes.data = device.data();
    return device;
  }

  /// Allocates memory for the results of `count` rays.
  DeviceResult result_for(std::size_t count, bool attributes) {
    check_cuda(cudaSetDevice(device_), "cudaSetDevice");
    if (hits_.size() < count) hits_ = DeviceArray<FirstHit>(heap_, count);
    if (attributes && hit_attributes_.size() < count) hit_attributes_ = DeviceArray<VoxelAttributes>(heap_, count);
    count_ = count;
    has_attributes_ = attributes;
    return {hits_.data(), attributes ? hit_attributes_.data() : nullptr, attributes_.data()};
  }

  int device_, multiprocessors_ = 0;
  Stream stream_;
  DeviceMemoryStats memory_stats_;
  DeviceHeap heap_{stream_.handle, memory_stats_};
  FirstHitView scene_;  ///< its spans refer to the device's arrays
  DeviceArray<FirstHitNode> nodes_, shells_[2];
  DeviceArray<VoxelAttributes> attributes_;
  DeviceArray<FirstHitRay> rays_;
  DeviceArray<float> starts_;
  DeviceArray<FirstHit> hits_;
  DeviceArray<VoxelAttributes> hit_attributes_;
  std::size_t count_ = 0;
  bool has_attributes_ = false;
  StopWatch watch_;
};

CudaFirstHits::CudaFirstHits(int device, const FirstHitView& scene) : impl_(std::make_unique<Impl>(device, scene)) {}
CudaFirstHits::~CudaFirstHits() = default;
void CudaFirstHits::upload(Span<const FirstHitRay> rays) { impl_->upload(rays); }
double CudaFirstHits::cast(const FirstHitCamera& camera, bool attributes) { return impl_->cast(camera, attributes); }
double CudaFirstHits::cast(bool attributes) { return impl_->cast(attributes); }
std::vector<FirstHit> CudaFirstHits::hits() const { return impl_->hits(); }
std::vector<VoxelAttributes> CudaFirstHits::attributes() const { return impl_->attributes(); }
std::uint64_t CudaFirstHits::device_bytes() const { return impl_->device_bytes(); }

}  // namespace gigabake::kernels
