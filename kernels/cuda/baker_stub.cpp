// CUDA backend of a build without nvcc: reports no devices and the reason.
#ifndef GIGABAKE_HAS_CUDA
#include "kernels/cuda/baker.h"

namespace gigabake::kernels {

class CudaInput {};
class CudaBaker::Impl {};

CudaDevices cuda_devices() { return {{}, "this gigabake was built without CUDA (no nvcc was found)"}; }

void start_device(int) { throw CudaFailure(cuda_devices().reason); }
std::uint64_t device_memory_bytes(int) { throw CudaFailure(cuda_devices().reason); }
double device_copy_rate(int) { throw CudaFailure(cuda_devices().reason); }

CudaBaker::CudaBaker(int, std::uint64_t) { throw CudaFailure(cuda_devices().reason); }
CudaBaker::~CudaBaker() = default;

// Never called: the constructor throws.
CellVolume CudaBaker::bake_cell(const CellInput&, const CellParameters&) { throw CudaFailure(cuda_devices().reason); }
std::shared_ptr<const CudaInput> CudaBaker::upload(const CellInput&) { throw CudaFailure(cuda_devices().reason); }
std::unique_ptr<CudaVolume> CudaBaker::bake(const CudaInput&, const CellParameters&) {
  throw CudaFailure(cuda_devices().reason);
}
std::unique_ptr<CudaVolume> CudaBaker::bake_at_once(const CudaInput&, const CellParameters&) {
  throw CudaFailure(cuda_devices().reason);
}
CellVolume CudaBaker::download(std::unique_ptr<CudaVolume>) { throw CudaFailure(cuda_devices().reason); }
std::uint64_t CudaBaker::volume_bytes() const { throw CudaFailure(cuda_devices().reason); }
std::uint64_t CudaBaker::expected_bytes() const { throw CudaFailure(cuda_devices().reason); }

}  // namespace gigabake::kernels
#endif
