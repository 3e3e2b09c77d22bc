#include "kernels/cuda/mip/levels.cuh"
#include "kernels/cuda/prune/node_levels.cuh"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 256;

__global__ void find_full_bricks(NodeLevels levels, std::uint32_t nodes, std::uint32_t* found) {
  const std::uint32_t node = blockIdx.x * blockDim.x + threadIdx.x;
  if (node >= nodes) return;
  const int lod = levels.lod_of(node);
  const std::uint32_t* first = levels.first[lod] + (node - levels.offset[lod]);
  if (is_full(first)) *found = 1;
}

struct NodeView {
  std::uint32_t *key, *first_child, *value;
  std::uint8_t *lod, *child_mask;
};

__global__ void make_nodes(NodeLevels levels, std::uint32_t nodes, NodeView out) {
  const std::uint32_t node = blockIdx.x * blockDim.x + threadIdx.x;
  if (node >= nodes) return;
  const int lod = levels.lod_of(node);
  const std::uint32_t brick = node - levels.offset[lod], key = levels.key[lod][brick];
  out.key[node] = key;
  out.value[node] = brick;
  out.lod[node] = std::uint8_t(lod);
  NodeChildren children;
  levels.for_each_child(lod, key,
                        [&](std::uint32_t child, std::uint32_t child_key) { children.add(child, child_key); });
  out.first_child[node] = children.first;
  out.child_mask[node] = children.mask;
}

bool any_full_brick(DeviceHeap& heap, const NodeLevels& levels, std::uint32_t nodes) {
  DeviceArray<std::uint32_t> full(heap, 1);
  full.clear_to_zero();
  find_full_bricks<<<grid_of(nodes, threads), threads, 0, heap.stream()>>>(levels, nodes, full.data());
  check_launch("find_full_bricks");
  std::uint32_t any_full = 0;
  heap.bring(&any_full, full.data(), sizeof any_full, "searching for full bricks");
  return any_full != 0;
}

}  // namespace

DeviceNodes make_device_nodes(DeviceHeap& heap, std::uint32_t count) {
  DeviceNodes nodes;
  nodes.count = count;
  nodes.key = DeviceArray<std::uint32_t>(heap, count);
  nodes.first_child = DeviceArray<std::uint32_t>(heap, count);
  nodes.value = DeviceArray<std::uint32_t>(heap, count);
  nodes.lod = DeviceArray<std::uint8_t>(heap, count);
  nodes.child_mask = DeviceArray<std::uint8_t>(heap, count);
  return nodes;
}

DeviceNodes brick_nodes(DeviceHeap& heap, const std::vector<DeviceLevel>& levels) {
  NodeLevels placed{};
  const std::uint32_t count = place_levels(levels, placed);
  if (any_full_brick(heap, placed, count)) return {};
  DeviceNodes nodes = make_device_nodes(heap, count);
  make_nodes<<<grid_of(count, threads), threads, 0, heap.stream()>>>(
      placed, count,
      {nodes.key.data(), nodes.first_child.data(), nodes.value.data(), nodes.lod.data(), nodes.child_mask.data()});
  check_launch("make_nodes");
  return nodes;
}

}  // namespace gigabake::kernels
