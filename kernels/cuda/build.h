/// What the CUDA kernels were compiled by and for.
#pragma once

#include <string>

namespace gigabake::kernels {

struct CudaBuild {
  std::string toolkit;        ///< "12.4.131"; empty: there are no CUDA kernels
  std::string architectures;  ///< as CMake names them: "80-real 90"
};

CudaBuild cuda_build();

}  // namespace gigabake::kernels
