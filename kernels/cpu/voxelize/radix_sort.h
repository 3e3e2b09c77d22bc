/// A stable least-significant-digit radix sort of 64-bit values by a range of their bits.
#pragma once

#include <cstdint>

#include "core/base/thread_pool.h"
#include "kernels/cpu/unset_array.h"

namespace gigabake::kernels {

/// Sorts `values` by bits [low_bit, high_bit). The number of bits is rounded up to a multiple of 8.
/// Cost    Per 8 bits, two reads and one write of `values`. A second buffer of the same size.
void radix_sort(UnsetArray<std::uint64_t>& values, int low_bit, int high_bit, const ThreadPool& pool);

}  // namespace gigabake::kernels
