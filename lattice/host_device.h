/// How one body compiles for the host and for a device, and the borrowed array that both take by value.
#pragma once

#include <cstddef>
#include <cstdint>

#if defined(__CUDACC__)
#define GB_HD __host__ __device__ inline
#else
#define GB_HD inline
#endif

/// A body of which there is one copy that callers jump to: one that few items need, so that those which do not need it
/// keep their instructions and registers.
#if defined(__CUDACC__)
#define GB_HD_ONE_COPY __host__ __device__ __noinline__ inline
#else
#define GB_HD_ONE_COPY __attribute__((noinline)) inline
#endif

/// A loop that a device must unroll, so that arrays which it indexes can be registers; one whose body it must not
/// repeat, because a large kernel waits for its instructions.
#if defined(__CUDA_ARCH__)
#define GB_UNROLL _Pragma("unroll")
#define GB_NO_UNROLL _Pragma("unroll 1")
#else
#define GB_UNROLL
#define GB_NO_UNROLL
#endif

namespace gigabake {

/// `index`, which a device must not turn into a 64-bit offset before it is used. For an index into a table that is only
/// loaded where something exists: ptxas 13.0 (sm_90) clears the 64-bit offset of what does not exist and reads it
/// before it is clear, so that the table is read gigabytes beyond its end. Found on 2026-11-23 with compute-sanitizer.
GB_HD std::uint32_t index_of_32_bits(std::uint32_t index) {
#if defined(__CUDA_ARCH__)
  asm("" : "+r"(index));
#endif
  return index;
}

/// Borrowed, contiguous. Trivially copyable: passes to a device by value.
template <class T>
struct Span {
  T* data = nullptr;
  std::size_t size = 0;
  GB_HD T& operator[](std::size_t i) const { return data[i]; }
  GB_HD bool empty() const { return size == 0; }
};

}  // namespace gigabake
