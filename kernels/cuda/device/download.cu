#include <functional>
#include <span>

#include "core/base/thread_pool.h"
#include "kernels/body/prune/node.h"
#include "kernels/cuda/device/download.cuh"

namespace gigabake::kernels {
namespace {

constexpr std::size_t alignment = 64;

/// Collection of arrays to download. run() copies all of them to one buffer and appends them to the host's arrays.
class Download {
 public:
  /// Adds the first `count` elements of an array. The host reads the copied bytes as elements of type Unit. It appends
  /// them to `to`, whose elements are Units or wider integers.
  template <class Unit, class T, class To>
  void add_as(const DeviceArray<T>& from, std::size_t count, std::vector<To>& to) {
    fill<Unit>(from, count, [&to](const Unit* begin, const Unit* end) { to.insert(to.end(), begin, end); });
  }

  template <class T, class To>
  void add(const DeviceArray<T>& from, std::size_t count, std::vector<To>& to) {
    add_as<T>(from, count, to);
  }

  /// Adds the offsets of a level's bricks. They are offset by the voxels that `to` already has.
  template <class T>
  void add_first(const DeviceArray<T>& from, std::size_t bricks, std::vector<std::uint64_t>& to) {
    fill<T>(from, bricks + 1, [&to](const T* begin, const T* end) {
      if (to.empty()) to.push_back(0);
      const std::uint64_t before = to.back();
      for (const T* first = begin + 1; first < end; ++first) to.push_back(before + *first);
    });
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
  /// Adds a copy of an array, which `append` then adds to the host's array.
  template <class Unit, class T, class Append>
  void fill(const DeviceArray<T>& from, std::size_t count, Append append) {
    const std::size_t at = bytes_, size = count * sizeof(T);
    bytes_ += (size + alignment - 1) / alignment * alignment;
    copies_.push_back({from.data(), at, size});
    fills_.push_back([at, size, append](const std::byte* buffer) {
      const Unit* values = reinterpret_cast<const Unit*>(buffer + at);
      append(values, values + size / sizeof(Unit));
    });
  }

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
  download.add_first(d.first, d.bricks, level.first);
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

void append_to_host(cudaStream_t stream, PinnedBuffer& pinned, std::span<const DeviceLevel> levels,
                    const ThreadPool& pool, std::span<Level> out) {
  Download download;
  for (std::size_t lod = 0; lod < levels.size(); ++lod) add(download, levels[lod], out[lod]);
  download.run(stream, pinned, pool);
}

}  // namespace gigabake::kernels
