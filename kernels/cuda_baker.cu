#include <array>
#include <bit>
#include <optional>

#include "kernels/cuda_baker.h"
#include "kernels/cuda_bin.cuh"
#include "kernels/cuda_input.cuh"
#include "kernels/cuda_levels.cuh"
#include "kernels/cuda_voxelize.cuh"
#include "kernels/prune.h"

namespace gigabake::kernels {
namespace {

constexpr int oldest_capability = 8;

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

struct Stream {
  cudaStream_t handle = nullptr;
  explicit Stream(int device) {
    check_cuda(cudaSetDevice(device), "cudaSetDevice");
    check_cuda(cudaStreamCreateWithFlags(&handle, cudaStreamNonBlocking), "cudaStreamCreate");
  }
  ~Stream() { cudaStreamDestroy(handle); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
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

template <class To, class T>
std::vector<To> to_host(const DeviceHeap& heap, const DeviceArray<T>& array, std::size_t size) {
  static_assert(sizeof(To) <= sizeof(T) || std::is_integral_v<To>);
  std::vector<T> host(size);
  check_cuda(cudaMemcpyAsync(host.data(), array.data(), size * sizeof(T), cudaMemcpyDeviceToHost, heap.stream()),
             "cudaMemcpyAsync (download)");
  check_cuda(cudaStreamSynchronize(heap.stream()), "cudaStreamSynchronize (download)");
  if constexpr (std::is_same_v<To, T>)
    return host;
  else
    return std::vector<To>(host.begin(), host.end());
}

/// Voxels stand on the device in one word, on the host byte by byte.
template <class Byte, class T>
std::vector<Byte> bytes_to_host(const DeviceHeap& heap, const DeviceArray<T>& array, std::size_t size) {
  std::vector<Byte> host(size * sizeof(T));
  check_cuda(cudaMemcpyAsync(host.data(), array.data(), host.size(), cudaMemcpyDeviceToHost, heap.stream()),
             "cudaMemcpyAsync (download)");
  check_cuda(cudaStreamSynchronize(heap.stream()), "cudaStreamSynchronize (download)");
  return host;
}

Level to_host(const DeviceHeap& heap, const DeviceLevel& d) {
  Level level;
  level.key = to_host<std::uint64_t>(heap, d.key, d.bricks);
  level.mask = to_host<std::uint64_t>(heap, d.mask, 8 * std::size_t(d.bricks));
  level.first = to_host<std::uint64_t>(heap, d.first, std::size_t(d.bricks) + 1);
  level.rgba = bytes_to_host<std::uint8_t>(heap, d.rgba, d.voxels);
  if (d.normal.size() != 0) level.normal = bytes_to_host<std::int8_t>(heap, d.normal, d.voxels);
  return level;
}

Nodes to_host(const DeviceHeap& heap, const DeviceNodes& d) {
  Nodes nodes;
  nodes.key = to_host<std::uint64_t>(heap, d.key, d.count);
  nodes.lod = to_host<std::uint8_t>(heap, d.lod, d.count);
  nodes.child_mask = to_host<std::uint8_t>(heap, d.child_mask, d.count);
  nodes.first_child = to_host<std::uint32_t>(heap, d.first_child, d.count);
  nodes.value = to_host<std::uint32_t>(heap, d.value, d.count);
  nodes.kind.assign(d.count, NodeKind::brick);
  nodes.normal.assign(d.count, {});
  return nodes;
}

}  // namespace

class CudaBaker::Impl {
 public:
  Impl(int device, std::uint64_t texture_bytes)
      : device_(device),
        stream_(device),
        clock_(stream_.handle),
        heap_(stream_.handle),
        tables_(heap_),
        textures_(heap_, texture_bytes != 0 ? texture_bytes : quarter_of(device)) {
    keep_pool(device);
  }

  void upload(const CellInput& input) {
    start();
    heap_.restart_peak();
    volume_ = {};
    input_.reset();
    input_.emplace(heap_, input, textures_, tables_.view());
    textured_ = input.textures.size != 0;
  }

  CellStats bake(const CellParameters& parameters) {
    start();
    volume_ = {};
    volume_.normals = parameters.normals;
    CellStats& stats = volume_.stats;
    const WindowView window = window_view(parameters);
    InputView input = input_->view();
    clock_.mark(0);
    DeviceArray<SnappedVertex> vertices;
    if (input.triangle_count != 0) vertices = snap_vertices(heap_, input, window);
    input.vertices = vertices.data();
    clock_.mark(1);
    BrickLists lists;
    if (input.triangle_count != 0) lists = bin_triangles(heap_, input, window, bin_capacity_, stats);
    clock_.mark(2);
    DeviceLevel finest;
    if (lists.bricks != 0)
      finest = voxelize(heap_, input, window, std::move(lists), parameters.normals, textured_, fill_ratios_, stats);
    clock_.mark(3);
    if (finest.bricks != 0) add_levels(std::move(finest), window.levels + 1, parameters);
    check_cuda(cudaStreamSynchronize(heap_.stream()), "cudaStreamSynchronize (bake)");
    stats.batches = 1;
    stats.peak_bytes = heap_.peak_bytes();
    stats.snap_s = clock_.between(0, 1);
    stats.sort_s = clock_.between(1, 2);
    stats.voxelize_s = clock_.between(2, 3);
    if (volume_.levels.empty()) return stats;
    stats.mip_s = clock_.between(3, 4);
    stats.prune_s = clock_.between(4, 5);
    return stats;
  }

  CellVolume download() {
    start();
    CellVolume out;
    out.stats = volume_.stats;
    for (const DeviceLevel& level : volume_.levels) out.levels.push_back(to_host(heap_, level));
    if (volume_.nodes.count != 0)
      out.nodes = to_host(heap_, volume_.nodes);
    else if (!out.levels.empty())
      out.nodes = prune(out.levels, host_);
    return out;
  }

 private:
  struct DeviceVolume {
    std::vector<DeviceLevel> levels;
    DeviceNodes nodes;
    CellStats stats;
    bool normals = true;
  };

  void start() { check_cuda(cudaSetDevice(device_), "cudaSetDevice"); }

  void add_levels(DeviceLevel finest, int lods, const CellParameters& parameters) {
    std::vector<DeviceLevel> coarser =
        coarser_levels(heap_, tables_.view(), finest, lods, parameters.mip, parameters.normals);
    volume_.levels.push_back(std::move(finest));
    for (DeviceLevel& level : coarser) volume_.levels.push_back(std::move(level));
    clock_.mark(4);
    volume_.nodes = brick_nodes(heap_, volume_.levels);
    clock_.mark(5);
  }

  int device_;
  Stream stream_;
  StreamClock clock_;
  DeviceHeap heap_;
  DeviceTables tables_;
  DeviceTextures textures_;
  BinCapacity bin_capacity_;
  FillRatios fill_ratios_;
  CpuPolicy host_{1};
  std::optional<DeviceInput> input_;
  bool textured_ = false;
  DeviceVolume volume_;
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
  DeviceHeap heap(stream.handle);
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

void CudaBaker::upload(const CellInput& input) { impl_->upload(input); }
CellStats CudaBaker::bake(const CellParameters& parameters) { return impl_->bake(parameters); }
CellVolume CudaBaker::download() { return impl_->download(); }

CellVolume CudaBaker::bake_cell(const CellInput& input, const CellParameters& parameters) {
  upload(input);
  bake(parameters);
  return download();
}

}  // namespace gigabake::kernels
