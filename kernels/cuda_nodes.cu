#include "kernels/cuda_levels.cuh"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 256;

__global__ void find_full_bricks(const std::uint32_t* first, std::uint32_t bricks, std::uint32_t* found) {
  const std::uint32_t b = blockIdx.x * blockDim.x + threadIdx.x;
  if (b < bricks && first[b + 1] - first[b] == brick_voxels) *found = 1;
}

struct NodeView {
  std::uint32_t *key, *first_child, *value;
  std::uint8_t *lod, *child_mask;
};

/// below_key: keys of the level below, or null at lod 0.
__global__ void make_nodes(const std::uint32_t* level_key, std::uint32_t bricks, const std::uint32_t* below_key,
                           std::uint32_t below_bricks, int lod, std::uint32_t offset, std::uint32_t below_offset,
                           NodeView out) {
  const std::uint32_t b = blockIdx.x * blockDim.x + threadIdx.x;
  if (b >= bricks) return;
  const std::uint32_t node = offset + b, key = level_key[b];
  out.key[node] = key;
  out.value[node] = b;
  out.lod[node] = std::uint8_t(lod);
  std::uint32_t first_child = UINT32_MAX;
  unsigned children = 0;
  if (below_key != nullptr) {
    std::uint32_t low = 0, high = below_bricks;  // the first brick below whose parent is not before this one
    while (low < high) {
      const std::uint32_t middle = (low + high) / 2;
      if (below_key[middle] >> 3 < key)
        low = middle + 1;
      else
        high = middle;
    }
    first_child = below_offset + low;
    for (; low < below_bricks && below_key[low] >> 3 == key; ++low) children |= 1u << (below_key[low] & 7);
  }
  out.first_child[node] = first_child;
  out.child_mask[node] = std::uint8_t(children);
}

}  // namespace

DeviceNodes brick_nodes(DeviceHeap& heap, const std::vector<DeviceLevel>& levels) {
  std::uint64_t count = 0;
  DeviceArray<std::uint32_t> full(heap, 1);
  full.clear_to_zero();
  for (const DeviceLevel& l : levels) {
    find_full_bricks<<<grid_of(l.bricks, threads), threads, 0, heap.stream()>>>(l.first.data(), l.bricks, full.data());
    check_launch("find_full_bricks");
    count += l.bricks;
  }
  if (count >= UINT32_MAX)
    throw std::length_error("an oct-tree of more than 2^32-1 nodes; use a smaller --cell-voxels");
  std::uint32_t any_full = 0;
  check_cuda(cudaMemcpyAsync(&any_full, full.data(), sizeof any_full, cudaMemcpyDeviceToHost, heap.stream()),
             "cudaMemcpyAsync (full bricks)");
  check_cuda(cudaStreamSynchronize(heap.stream()), "cudaStreamSynchronize (full bricks)");
  DeviceNodes nodes;
  if (any_full != 0) return nodes;
  nodes.count = std::uint32_t(count);
  nodes.key = DeviceArray<std::uint32_t>(heap, count);
  nodes.first_child = DeviceArray<std::uint32_t>(heap, count);
  nodes.value = DeviceArray<std::uint32_t>(heap, count);
  nodes.lod = DeviceArray<std::uint8_t>(heap, count);
  nodes.child_mask = DeviceArray<std::uint8_t>(heap, count);
  const NodeView out{nodes.key.data(), nodes.first_child.data(), nodes.value.data(), nodes.lod.data(),
                     nodes.child_mask.data()};
  std::uint32_t offset = 0;  // the coarsest level's nodes come first
  for (int l = int(levels.size()) - 1; l >= 0; --l) {
    const DeviceLevel* below = l == 0 ? nullptr : &levels[std::size_t(l - 1)];
    const std::uint32_t bricks = levels[std::size_t(l)].bricks;
    make_nodes<<<grid_of(bricks, threads), threads, 0, heap.stream()>>>(
        levels[std::size_t(l)].key.data(), bricks, below == nullptr ? nullptr : below->key.data(),
        below == nullptr ? 0 : below->bricks, l, offset, offset + bricks, out);
    check_launch("make_nodes");
    offset += bricks;
  }
  return nodes;
}

}  // namespace gigabake::kernels
