/// Macros that compile functions for host and device, and a borrowed array that is passed by value.
#pragma once

#include <cstddef>
#include <cstdint>

#if defined(__CUDACC__)
#define GB_HD __host__ __device__ inline
#else
#define GB_HD inline
#endif

/// Marks a function that is never inlined. Use it for code that few work items execute: inlining it would cost the
/// other work items registers and instruction-cache space.
#if defined(__CUDACC__)
#define GB_HD_NOINLINE __host__ __device__ __noinline__ inline
#else
#define GB_HD_NOINLINE __attribute__((noinline)) inline
#endif

/// GB_UNROLL marks a loop that a device must unroll, so that arrays indexed in it stay in registers. GB_NO_UNROLL
/// prevents unrolling, because large kernels miss the instruction cache. GB_UNROLL_ALWAYS also marks a loop for hosts:
/// the shifts in it depend only on its counter, but compilers do not unroll a loop of this size by themselves.
#if defined(__CUDA_ARCH__)
#define GB_UNROLL _Pragma("unroll")
#define GB_UNROLL_ALWAYS _Pragma("unroll")
#define GB_NO_UNROLL _Pragma("unroll 1")
#else
#define GB_UNROLL
#if defined(__GNUC__) && !defined(__clang__) && !defined(__CUDACC__)
#define GB_UNROLL_ALWAYS _Pragma("GCC unroll 8")
#else
#define GB_UNROLL_ALWAYS
#endif
#define GB_NO_UNROLL
#endif

namespace gigabake {

/// Returns `index` and keeps the compiler from widening it to a 64-bit offset early. Use it for an index into a table
/// that is read only under a condition. Without it, ptxas 13.0 (sm_90) lets an inactive work item load from a wrong
/// 64-bit offset, gigabytes beyond the table. compute-sanitizer reports such a load.
GB_HD std::uint32_t index_of_32_bits(std::uint32_t index) {
#if defined(__CUDA_ARCH__)
  asm("" : "+r"(index));
#endif
  return index;
}

/// A borrowed, contiguous array. It is trivially copyable and passes to a device by value.
template <class T>
struct Span {
  T* data = nullptr;
  std::size_t size = 0;
  GB_HD T& operator[](std::size_t i) const { return data[i]; }
  GB_HD bool empty() const { return size == 0; }
};

}  // namespace gigabake
