#include <algorithm>

#include "core/base/thread_pool.h"
#include "core/base/trace.h"
#include "kernels/cpu/mip/level_hash.h"
#include "kernels/cpu/prune/prune.h"
#include "kernels/cpu/voxelize/quantize_groups.h"
#include "kernels/cuda/baker.h"
#include "kernels/cuda/cell.cuh"
#include "kernels/cuda/device/download.cuh"
#include "kernels/cuda/device/input.cuh"
#include "kernels/cuda/device/stream.cuh"
#include "kernels/cuda/mip/hash.cuh"

namespace gigabake::kernels {
namespace {

constexpr int oldest_capability = 8;

/// Keeps freed memory in the pool: returning it to the driver between cells takes longer than all kernels.
void keep_pool(int device) {
  cudaMemPool_t pool;
  check_cuda(cudaDeviceGetDefaultMemPool(&pool, device), "cudaDeviceGetDefaultMemPool");
  std::uint64_t threshold = UINT64_MAX;
  check_cuda(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &threshold), "cudaMemPoolSetAttribute");
}

}  // namespace

class CudaInput : public DeviceInput {
 public:
  using DeviceInput::DeviceInput;
};

class CudaBaker::Impl {
 public:
  Impl(int device, std::uint64_t texture_bytes)
      : device_(device),
        upload_stream_(device),
        bake_stream_(device, StreamPriority::high),
        download_stream_(device),
        download_clock_(download_stream_.handle),
        upload_heap_(upload_stream_.handle, memory_stats_),
        bake_heap_(bake_stream_.handle, memory_stats_),
        download_heap_(download_stream_.handle, memory_stats_),
        tables_(upload_heap_),
        textures_(upload_heap_, texture_bytes != 0 ? texture_bytes : device_memory_bytes(device) / 4),
        bake_(bake_heap_, tables_.view()) {
    keep_pool(device);
  }

  std::shared_ptr<const CudaInput> upload(const CellInput& input) {
    const TraceSpan span("upload");
    start();
    return std::make_shared<const CudaInput>(upload_heap_, input, textures_, tables_.view());
  }

  std::unique_ptr<CudaVolume> bake(const CudaInput& uploaded, const CellParameters& parameters, bool may_split) {
    start();
    memory_stats_.restart_peak();
    const std::uint64_t before = memory_stats_.live_bytes();
    auto cell = std::make_unique<BakedCell>();
    const bool is_baked = bake_.bake(uploaded, parameters, may_split, *cell);
    const std::uint64_t peak = memory_stats_.peak_bytes();
    cell->cell_stats.peak_bytes = peak;
    expected_bytes_ = std::max(peak - std::min(peak, before), expected_bytes_ / 8 * 7);
    return is_baked ? std::move(cell) : nullptr;
  }

  std::uint64_t volume_bytes() const { return bake_heap_.live(); }
  std::uint64_t expected_bytes() const { return expected_bytes_; }

  CellVolume download(std::unique_ptr<BakedCell> cell) {
    start();
    if (cell->max_error != 0) return download_approximate(*cell);
    CellVolume out;
    if (!cell->levels.empty()) {
      download_clock_.mark(0);
      out.content_hash = level_hashes(download_heap_, cell->levels, cell->window_min);
      download_clock_.mark(1);
      CellVolume at_once = to_host(download_stream_.handle, pinned_, cell->levels, cell->nodes, host_);
      out.levels = std::move(at_once.levels);
      out.nodes = std::move(at_once.nodes);
      cell->cell_stats.hash_s = download_clock_.between(0, 1);
    } else {
      out.levels = std::move(cell->host_levels);
      out.content_hash = std::move(cell->host_hashes);
    }
    if (out.nodes.key.empty() && !out.levels.empty()) out.nodes = prune(out.levels, host_);
    out.above = std::move(cell->above);
    out.stats = cell->cell_stats;
    return out;
  }

 private:
  /// Approximates, hashes and prunes a cell on the host that was baked in parts. Its parts are not approximated on the
  /// device, because the coarser levels need exact voxels.
  CellVolume download_approximate(BakedCell& cell) {
    CellVolume out;
    out.levels = std::move(cell.host_levels);
    quantize_groups(out.levels, cell.max_error, host_);
    out.content_hash = level_hashes(out.levels, cell.window_min, host_);
    if (!out.levels.empty()) out.nodes = prune(out.levels, host_);
    out.above = std::move(cell.above);
    out.stats = cell.cell_stats;
    return out;
  }

  void start() { check_cuda(cudaSetDevice(device_), "cudaSetDevice"); }

  int device_;
  // A cell is computed by a chain of short kernels. The large kernels of packers must not delay each of them.
  Stream upload_stream_, bake_stream_, download_stream_;
  StreamClock download_clock_;
  DeviceMemoryStats memory_stats_;
  DeviceHeap upload_heap_, bake_heap_, download_heap_;
  DeviceTables tables_;
  DeviceTextures textures_;
  CellBake bake_;
  std::uint64_t expected_bytes_ = 0;
  PinnedBuffer pinned_;
  ThreadPool host_{download_threads};
};

CudaDevices cuda_devices() {
  CudaDevices devices;
  int count = 0;
  const cudaError_t code = cudaGetDeviceCount(&count);
  if (code != cudaSuccess) {
    cudaGetLastError();
    devices.reason = cudaGetErrorString(code);
    return devices;
  }
  for (int d = 0; d < count; ++d) {
    cudaDeviceProp p;
    check_cuda(cudaGetDeviceProperties(&p, d), "cudaGetDeviceProperties");
    if (p.major >= oldest_capability)
      devices.usable.push_back(d);
    else
      devices.reason = std::string(p.name) + " has compute capability " + std::to_string(p.major) + "." +
                       std::to_string(p.minor) + "; at least 8.0 is required";
  }
  if (count == 0) devices.reason = "this machine has no CUDA device";
  return devices;
}

void start_device(int device) {
  check_cuda(cudaSetDevice(device), "cudaSetDevice");
  check_cuda(cudaFree(nullptr), "cudaFree (start of the device)");
}

std::uint64_t device_memory_bytes(int device) {
  cudaDeviceProp p;
  check_cuda(cudaGetDeviceProperties(&p, device), "cudaGetDeviceProperties");
  return p.totalGlobalMem;
}

double device_copy_rate(int device) {
  constexpr std::size_t bytes = std::size_t(1) << 30;
  constexpr int copies = 5;
  const Stream stream(device);
  DeviceMemoryStats memory_stats;
  DeviceHeap heap(stream.handle, memory_stats);
  const DeviceArray<std::uint8_t> from(heap, bytes), to(heap, bytes);
  StreamClock clock(stream.handle);
  for (int i = 0; i <= copies; ++i) {
    if (i == 1) clock.mark(0);  // the first copy warms up
    check_cuda(cudaMemcpyAsync(to.data(), from.data(), bytes, cudaMemcpyDeviceToDevice, stream.handle),
               "cudaMemcpyAsync (copy rate)");
  }
  clock.mark(1);
  check_cuda(cudaStreamSynchronize(stream.handle), "cudaStreamSynchronize (copy rate)");
  return 2.0 * copies * bytes / clock.between(0, 1);
}

CudaBaker::CudaBaker(int device, std::uint64_t texture_bytes) : impl_(std::make_unique<Impl>(device, texture_bytes)) {}
CudaBaker::~CudaBaker() = default;

std::shared_ptr<const CudaInput> CudaBaker::upload(const CellInput& input) { return impl_->upload(input); }
std::unique_ptr<CudaVolume> CudaBaker::bake(const CudaInput& input, const CellParameters& parameters) {
  return impl_->bake(input, parameters, true);
}
std::unique_ptr<CudaVolume> CudaBaker::bake_at_once(const CudaInput& input, const CellParameters& parameters) {
  return impl_->bake(input, parameters, false);
}
CellVolume CudaBaker::download(std::unique_ptr<CudaVolume> volume) {
  return impl_->download(std::unique_ptr<BakedCell>(static_cast<BakedCell*>(volume.release())));
}

std::uint64_t CudaBaker::volume_bytes() const { return impl_->volume_bytes(); }
std::uint64_t CudaBaker::expected_bytes() const { return impl_->expected_bytes(); }

CellVolume CudaBaker::bake_cell(const CellInput& input, const CellParameters& parameters) {
  return download(bake(*upload(input), parameters));
}

}  // namespace gigabake::kernels
