#include "kernels/cuda/device/build.h"

namespace gigabake::kernels {

#ifdef GIGABAKE_CUDA_TOOLKIT
CudaBuild cuda_build() { return {GIGABAKE_CUDA_TOOLKIT, GIGABAKE_CUDA_ARCHITECTURES}; }
#else
CudaBuild cuda_build() { return {}; }
#endif

}  // namespace gigabake::kernels
