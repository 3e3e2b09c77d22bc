/// A stable least-significant-digit radix sort of 64-bit values by a range of their bits.
#pragma once

#include <cstdint>

#include "core/base/thread_pool.h"
#include "kernels/cpu/unset_array.h"

namespace gigabake::kernels {

/// Sorts by bits [low_bit, high_bit).
/// Cost    One read for the counts, one read and one write of `values` per 8 bits; a second buffer of the same size.
void radix_sort(UnsetArray<std::uint64_t>& values, int low_bit, int high_bit, const ThreadPool& pool);

}  // namespace gigabake::kernels
