// Stubs of the CUDA caster for builds without nvcc.
#ifndef GIGABAKE_HAS_CUDA
#include "kernels/cuda/baker.h"
#include "kernels/render/caster.h"

namespace gigabake::kernels {

std::unique_ptr<Caster> make_cuda_caster(const CastScene&, const PoolSizes&, const PagePoolSize&, int,
                                         const ThreadPool&) {
  throw CudaFailure(cuda_devices().reason);
}

std::shared_ptr<const SurfaceShader> lit_shader(const LitShader& shader) { return host_shader(shader); }
std::shared_ptr<const SurfaceShader> height_shader(const HeightShader& shader) { return host_shader(shader); }
std::shared_ptr<const SurfaceShader> slope_shader(const SlopeShader& shader) { return host_shader(shader); }

}  // namespace gigabake::kernels
#endif
