// The stub of device packing for builds without nvcc. It always throws.
#ifndef GIGABAKE_HAS_CUDA
#include "kernels/cuda/baker.h"
#include "kernels/pack/device_pack.h"

namespace gigabake::kernels {

DevicePacked pack_on_device(int, std::span<const std::uint8_t>, std::span<const RawChunk>, int) {
  throw CudaFailure(cuda_devices().reason);
}

}  // namespace gigabake::kernels
#endif
