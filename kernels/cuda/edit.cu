#include <limits>
#include <string>
#include <vector>

#include "kernels/cuda/device/download.cuh"
#include "kernels/cuda/edit.cuh"

namespace gigabake::kernels {
namespace {

/// Uploads host values as `bytes / sizeof(T)` elements of the device's type T.
template <class T>
DeviceArray<T> upload(DeviceHeap& heap, const void* host, std::size_t bytes) {
  DeviceArray<T> array(heap, bytes / sizeof(T));
  if (bytes != 0) upload_async(array.data(), host, bytes, heap.stream(), "cudaMemcpyAsync (edited level)");
  return array;
}

DeviceArray<std::uint32_t> upload_narrowed(DeviceHeap& heap, const std::vector<std::uint64_t>& host) {
  const std::vector<std::uint32_t> narrow(host.begin(), host.end());
  DeviceArray<std::uint32_t> array = upload<std::uint32_t>(heap, narrow.data(), narrow.size() * sizeof(std::uint32_t));
  wait_for(heap.stream(), "cudaStreamSynchronize (edited keys)");
  return array;
}

DeviceLevel to_device(DeviceHeap& heap, const Level& host) {
  DeviceLevel level;
  if (host.key.empty()) return level;
  if (host.first.back() > std::numeric_limits<std::uint32_t>::max())
    throw DeviceFull(std::to_string(host.first.back()) + " voxels, beyond 32-bit indices");
  level.bricks = std::uint32_t(host.key.size());
  level.voxels = std::uint32_t(host.first.back());
  level.key = upload_narrowed(heap, host.key);
  level.first = upload_narrowed(heap, host.first);
  level.mask = upload<std::uint64_t>(heap, host.mask.data(), host.mask.size() * sizeof(std::uint64_t));
  level.rgba = upload<std::uint32_t>(heap, host.rgba.data(), host.rgba.size());
  if (!host.normal.empty()) level.normal = upload<std::uint16_t>(heap, host.normal.data(), host.normal.size());
  if (!host.directional_coverage.empty())
    level.directional_coverage =
        upload<std::uint8_t>(heap, host.directional_coverage.data(), host.directional_coverage.size());
  wait_for(heap.stream(), "cudaStreamSynchronize (edited level)");  // the host's arrays may be freed now
  return level;
}

}  // namespace

void edit_level(DeviceHeap& heap, PinnedBuffer& pinned, const LevelEdits& edits, KeyRange range, const ThreadPool& pool,
                DeviceLevel& level) {
  Level host;
  if (level.bricks != 0) host = std::move(to_host(heap.stream(), pinned, {&level, 1}, DeviceNodes{}, pool).levels[0]);
  level = DeviceLevel();
  edits.apply(host, range.first, range.end);
  level = to_device(heap, host);
}

}  // namespace gigabake::kernels
