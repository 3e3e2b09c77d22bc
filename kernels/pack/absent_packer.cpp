// The packer of a build without nvcc: it cannot be made, as no CudaBaker can.
#ifndef GIGABAKE_HAS_CUDA
#include "kernels/pack/packer.h"

namespace gigabake::kernels {

class CudaPacker::Impl {};

CudaPacker::CudaPacker(int) { throw CudaFailure(cuda_devices().reason); }
CudaPacker::~CudaPacker() = default;

// No object exists to call this on.
std::optional<PackedCell> CudaPacker::pack(const CudaVolume&, const PackRequest&) {
  throw CudaFailure(cuda_devices().reason);
}

}  // namespace gigabake::kernels
#endif
