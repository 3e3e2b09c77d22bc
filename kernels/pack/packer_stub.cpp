// The stub of CudaPacker for builds without nvcc. Its constructor always throws, like that of CudaBaker.
#ifndef GIGABAKE_HAS_CUDA
#include "kernels/pack/packer.h"

namespace gigabake::kernels {

class CudaPacker::Impl {};

CudaPacker::CudaPacker(int) { throw CudaFailure(cuda_devices().reason); }
CudaPacker::~CudaPacker() = default;

// Unreachable, because no object can be created.
std::optional<PackedCell> CudaPacker::pack(const CudaVolume&, const PackRequest&) {
  throw CudaFailure(cuda_devices().reason);
}

}  // namespace gigabake::kernels
#endif
