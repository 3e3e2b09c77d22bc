/// The few types every kernel body shares. Bodies are host/device functions over borrowed spans; nothing here owns.
#pragma once

#include <cstddef>
#include <cstdint>

#if defined(__CUDACC__)
#define GB_HD __host__ __device__ inline
#else
#define GB_HD inline
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

namespace gigabake::kernels {

/// Borrowed, contiguous. Trivially copyable: passes to a device by value.
template <class T>
struct Span {
  T* data = nullptr;
  std::size_t size = 0;
  GB_HD T& operator[](std::size_t i) const { return data[i]; }
  GB_HD bool empty() const { return size == 0; }
};

inline constexpr int brick_edge = 8;
inline constexpr int brick_voxels = 512;
inline constexpr int subvoxel_bits = 8;  ///< the snap lattice: 1/256 voxel
inline constexpr std::int64_t subvoxels = 1 << subvoxel_bits;

enum class SurfaceRule : std::uint8_t { area, conservative, thin };
enum class MipFilter : std::uint8_t { coverage, thesis, box };
enum class AlphaMode : std::uint8_t { opaque, mask, blend };
enum class Wrap : std::uint8_t { repeat, mirrored_repeat, clamp_to_edge };

}  // namespace gigabake::kernels
