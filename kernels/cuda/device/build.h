/// Compiler and target architectures of the CUDA kernels.
#pragma once

#include <string>

namespace gigabake::kernels {

struct CudaBuild {
  std::string toolkit;        ///< "12.4.131"; empty if built without CUDA
  std::string architectures;  ///< in CMake's notation: "80-real 90"
};

CudaBuild cuda_build();

}  // namespace gigabake::kernels
