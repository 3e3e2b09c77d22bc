#include <algorithm>
#include <array>

#include "kernels/approximate.h"
#include "kernels/cuda_baker.h"
#include "kernels/cuda_bin.cuh"
#include "kernels/cuda_download.cuh"
#include "kernels/cuda_hash.cuh"
#include "kernels/cuda_input.cuh"
#include "kernels/cuda_levels.cuh"
#include "kernels/cuda_stream.cuh"
#include "kernels/cuda_voxelize.cuh"
#include "kernels/level_hash.h"
#include "kernels/prune.h"

namespace gigabake::kernels {
namespace {

constexpr int oldest_capability = 8;
/// The largest level's colours, its normals, and the rest.
constexpr int download_threads = 3;

/// Times between marks in the stream.
class StreamClock {
 public:
  explicit StreamClock(cudaStream_t stream) : stream_(stream) {
    for (cudaEvent_t& e : events_) check_cuda(cudaEventCreate(&e), "cudaEventCreate");
  }
  ~StreamClock() {
    for (cudaEvent_t e : events_) cudaEventDestroy(e);
  }
  StreamClock(const StreamClock&) = delete;
  StreamClock& operator=(const StreamClock&) = delete;

  void mark(int i) { check_cuda(cudaEventRecord(events_[std::size_t(i)], stream_), "cudaEventRecord"); }
  /// Seconds between marks; the stream must have passed both.
  double between(int i, int j) const {
    float ms = 0;
    check_cuda(cudaEventElapsedTime(&ms, events_[std::size_t(i)], events_[std::size_t(j)]), "cudaEventElapsedTime");
    return ms * 1e-3;
  }

 private:
  cudaStream_t stream_;
  std::array<cudaEvent_t, 6> events_{};
};

/// Freed memory stays with the pool: giving it back to the driver between cells costs more than all kernels.
void keep_pool(int device) {
  cudaMemPool_t pool;
  check_cuda(cudaDeviceGetDefaultMemPool(&pool, device), "cudaDeviceGetDefaultMemPool");
  std::uint64_t threshold = UINT64_MAX;
  check_cuda(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &threshold), "cudaMemPoolSetAttribute");
}

std::uint64_t quarter_of(int device) {
  cudaDeviceProp p;
  check_cuda(cudaGetDeviceProperties(&p, device), "cudaGetDeviceProperties");
  return p.totalGlobalMem / 4;
}

class Volume : public CudaVolume {
 public:
  const CellStats& stats() const override { return cell_stats; }

  std::vector<DeviceLevel> levels;
  DeviceNodes nodes;
  std::int64_t window_min[3] = {};
  std::uint32_t max_error = 0;
  CellStats cell_stats;
};

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
        bake_stream_(device),
        download_stream_(device),
        clock_(bake_stream_.handle),
        download_clock_(download_stream_.handle),
        upload_heap_(upload_stream_.handle, books_),
        bake_heap_(bake_stream_.handle, books_),
        download_heap_(download_stream_.handle, books_),
        tables_(upload_heap_),
        textures_(upload_heap_, texture_bytes != 0 ? texture_bytes : quarter_of(device)) {
    keep_pool(device);
  }

  std::shared_ptr<const CudaInput> upload(const CellInput& input) {
    start();
    return std::make_shared<const CudaInput>(upload_heap_, input, textures_, tables_.view());
  }

  std::unique_ptr<CudaVolume> bake(const CudaInput& uploaded, const CellParameters& parameters) {
    start();
    books_.restart_peak();
    auto volume = std::make_unique<Volume>();
    CellStats& stats = volume->cell_stats;
    clock_.mark(0);
    InputView input = uploaded.view();
    if (input.triangle_count != 0) bake_levels(input, uploaded.is_textured(), parameters, *volume);
    check_cuda(cudaStreamSynchronize(bake_stream_.handle), "cudaStreamSynchronize (bake)");
    stats.batches = 1;
    stats.peak_bytes = books_.peak_bytes();
    if (input.triangle_count == 0) return volume;
    stats.snap_s = clock_.between(0, 1);
    stats.sort_s = clock_.between(1, 2);
    if (volume->levels.empty()) return volume;
    stats.voxelize_s = clock_.between(2, 3);
    stats.mip_s = clock_.between(3, 4);
    stats.prune_s = clock_.between(4, 5);
    return volume;
  }

  CellVolume download(const Volume& volume) {
    start();
    const cudaStream_t stream = download_stream_.handle;
    if (volume.levels.empty()) {
      CellVolume empty;
      empty.stats = volume.cell_stats;
      return empty;
    }
    if (volume.max_error != 0) return download_approximate(volume);
    download_clock_.mark(0);
    const std::vector<Sum128> hashes = level_hashes(download_heap_, volume.levels, volume.window_min);
    download_clock_.mark(1);
    CellVolume out = to_host(stream, pinned_, volume.levels, volume.nodes, host_);
    if (volume.nodes.count == 0) out.nodes = prune(out.levels, host_);
    out.content_hash = hashes;
    out.stats = volume.cell_stats;
    out.stats.hash_s = download_clock_.between(0, 1);
    return out;
  }

 private:
  /// What voxels have in common, hash and nodes are the host's affair here.
  CellVolume download_approximate(const Volume& volume) {
    CellVolume out = to_host(download_stream_.handle, pinned_, volume.levels, {}, host_);
    approximate(out.levels, volume.max_error, host_);
    out.content_hash = level_hashes(out.levels, volume.window_min, host_);
    out.nodes = prune(out.levels, host_);
    out.stats = volume.cell_stats;
    return out;
  }

  void start() { check_cuda(cudaSetDevice(device_), "cudaSetDevice"); }

  void bake_levels(InputView& input, bool textured, const CellParameters& parameters, Volume& volume) {
    CellStats& stats = volume.cell_stats;
    const WindowView window = window_view(parameters);
    const DeviceArray<SnappedVertex> vertices = snap_vertices(bake_heap_, input, window);
    input.vertices = vertices.data();
    clock_.mark(1);
    BrickLists lists = bin_triangles(bake_heap_, input, window, bin_capacity_, stats);
    clock_.mark(2);
    if (lists.bricks == 0) return;
    DeviceLevel finest =
        voxelize(bake_heap_, input, window, std::move(lists), parameters.normals, textured, fill_ratios_, stats);
    clock_.mark(3);
    if (finest.bricks == 0) return;
    volume.max_error = parameters.max_error;
    std::copy(std::begin(parameters.window_min), std::end(parameters.window_min), volume.window_min);
    std::vector<DeviceLevel> coarser =
        coarser_levels(bake_heap_, tables_.view(), finest, window.levels + 1, parameters.mip, parameters.normals);
    volume.levels.push_back(std::move(finest));
    for (DeviceLevel& level : coarser) volume.levels.push_back(std::move(level));
    clock_.mark(4);
    volume.nodes = brick_nodes(bake_heap_, volume.levels);
    clock_.mark(5);
  }

  int device_;
  Stream upload_stream_, bake_stream_, download_stream_;
  StreamClock clock_, download_clock_;
  DeviceBooks books_;
  DeviceHeap upload_heap_, bake_heap_, download_heap_;
  DeviceTables tables_;
  DeviceTextures textures_;
  BinCapacity bin_capacity_;
  FillRatios fill_ratios_;
  PinnedBuffer pinned_;
  CpuPolicy host_{download_threads};
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
                       std::to_string(p.minor) + ", 8.0 is the oldest that works";
  }
  if (count == 0) devices.reason = "this machine has no CUDA device";
  return devices;
}

double device_copy_rate(int device) {
  constexpr std::size_t bytes = std::size_t(1) << 30;
  constexpr int copies = 5;
  const Stream stream(device);
  DeviceBooks books;
  DeviceHeap heap(stream.handle, books);
  const DeviceArray<std::uint8_t> from(heap, bytes), to(heap, bytes);
  StreamClock clock(stream.handle);
  for (int i = 0; i <= copies; ++i) {
    if (i == 1) clock.mark(0);  // the first one warms up
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
  return impl_->bake(input, parameters);
}
CellVolume CudaBaker::download(const CudaVolume& volume) { return impl_->download(static_cast<const Volume&>(volume)); }

CellVolume CudaBaker::bake_cell(const CellInput& input, const CellParameters& parameters) {
  return download(*bake(*upload(input), parameters));
}

}  // namespace gigabake::kernels
