/// Selection of the indices that satisfy a predicate.
#pragma once

#include <cstdint>
#include <cub/device/device_select.cuh>
#include <thrust/iterator/counting_iterator.h>

#include "kernels/cuda/device/memory.cuh"

namespace gigabake::kernels {

/// Writes the indices i < n for which is_wanted(i) is true to `to`, in ascending order. The predicate runs on the
/// device. `to` must have capacity for n indices. Waits for the stream and returns the number of written indices.
template <class Predicate>
std::uint32_t select_indices(DeviceHeap& heap, std::uint32_t n, const Predicate& is_wanted, std::uint32_t* to) {
  const thrust::counting_iterator<std::uint32_t> counting(0);
  const DeviceArray<std::uint32_t> count(heap, 1);
  with_temporary(heap, [&](void* temporary, std::size_t& bytes) {
    check_cuda(cub::DeviceSelect::If(temporary, bytes, counting, to, count.data(), n, is_wanted, heap.stream()),
               "DeviceSelect");
  });
  std::uint32_t selected = 0;
  heap.bring(&selected, count.data(), sizeof selected, "selecting indices");
  return selected;
}

}  // namespace gigabake::kernels
