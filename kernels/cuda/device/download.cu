#include <functional>
#include <span>

#include "core/base/thread_pool.h"
#include "kernels/body/prune/node.h"
#include "kernels/cuda/device/download.cuh"

namespace gigabake::kernels {
namespace {

constexpr std::size_t alignment = 64;

/// Collection of arrays to download. run() copies all of them to one buffer and fills the host's arrays from it.
class Download {
 public:
  /// Adds the first `count` elements of an array. The host reads the copied bytes as elements of type Unit. It assigns
  /// them to `to`, whose elements are Units or wider integers.
  template <class Unit, class T, class To>
  void add_as(const DeviceArray<T>& from, std::size_t count, std::vector<To>& to) {
    const std::size_t at = bytes_, size = count * sizeof(T);
    bytes_ += (size + alignment - 1) / alignment * alignment;
    copies_.push_back({from.data(), at, size});
    fills_.push_back([at, size, &to](const std::byte* buffer) {
      const Unit* values = reinterpret_cast<const Unit*>(buffer + at);
      to.assign(values, values + size / sizeof(Unit));
    });
  }

  template <class T, class To>
  void add(const DeviceArray<T>& from, std::size_t count, std::vector<To>& to) {
    add_as<T>(from, count, to);
  }

  void run(cudaStream_t stream, PinnedBuffer& pinned, const ThreadPool& pool) const {
    std::byte* buffer = pinned.reserve(bytes_);
    for (const Copy& c : copies_) download_async(buffer + c.at, c.from, c.bytes, stream, "cudaMemcpyAsync (download)");
    wait_for(stream, "cudaStreamSynchronize (download)");
    pool.parallel_for(fills_.size(), 1, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t i = begin; i < end; ++i) fills_[i](buffer);
    });
  }

 private:
  struct Copy {
    const void* from;
    std::size_t at, bytes;
  };
  std::size_t bytes_ = 0;
  std::vector<Copy> copies_;
  std::vector<std::function<void(const std::byte*)>> fills_;
};

void add(Download& download, const DeviceLevel& d, Level& level) {
  download.add_as<std::uint8_t>(d.rgba, d.voxels, level.rgba);  // largest array first
  if (!d.normal.empty()) download.add_as<std::int8_t>(d.normal, d.voxels, level.normal);
  if (!d.directional_coverage.empty())
    download.add(d.directional_coverage, directional_coverage_bytes * std::size_t(d.voxels),
                 level.directional_coverage);
  download.add(d.mask, 8 * std::size_t(d.bricks), level.mask);
  download.add(d.key, d.bricks, level.key);
  download.add(d.first, std::size_t(d.bricks) + 1, level.first);
}

void add(Download& download, const DeviceNodes& d, NodeTable& nodes) {
  download.add(d.key, d.count, nodes.key);
  download.add(d.lod, d.count, nodes.lod);
  download.add(d.child_mask, d.count, nodes.child_mask);
  download.add(d.first_child, d.count, nodes.first_child);
  download.add(d.value, d.count, nodes.value);
  set_all_bricks(nodes, d.count);
}

}  // namespace

CellVolume to_host(cudaStream_t stream, PinnedBuffer& pinned, std::span<const DeviceLevel> levels,
                   const DeviceNodes& nodes, const ThreadPool& pool) {
  CellVolume out;
  out.levels.resize(levels.size());
  Download download;
  for (std::size_t lod = 0; lod < levels.size(); ++lod) add(download, levels[lod], out.levels[lod]);
  if (nodes.count != 0) add(download, nodes, out.nodes);
  out.nodes.has_finest_planes = !levels.empty() && !levels[0].directional_coverage.empty();
  download.run(stream, pinned, pool);
  return out;
}

}  // namespace gigabake::kernels
