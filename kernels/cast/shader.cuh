/// Shaders for both casters, in files that nvcc compiles (kernels/cast/shader.h).
#pragma once

#include <cuda_runtime.h>

#include "kernels/cast/shader.h"
#include "kernels/cast/tile_grid.cuh"

namespace gigabake::kernels {

template <class Shader>
__global__ void shade_pixels(ShadedTile tile, Shader shader, CastRay* out) {
  int x, y;
  if (!pixel_of_thread(tile.tile, x, y)) return;
  const std::size_t i = std::size_t(y) * std::size_t(tile.tile.width) + std::size_t(x);
  out[i] = shaded_ray(tile, shader, i);
}

template <class Shader>
std::shared_ptr<const SurfaceShader> device_shader(const Shader& shader) {
  struct OnBoth final : SurfaceShader {
    Shader shader;
    explicit OnBoth(const Shader& s) : shader(s) {}
    void on_host(const ShadedTile& tile, CastRay* out, const ThreadPool& policy) const override {
      shade_on_host(tile, shader, out, policy);
    }
    void on_device(const ShadedTile& tile, CastRay* out, void* stream) const override {
      shade_pixels<<<grid_of_tile(tile.tile), tile_threads, 0, static_cast<cudaStream_t>(stream)>>>(tile, shader, out);
      if (const cudaError_t code = cudaGetLastError(); code != cudaSuccess)
        throw CudaFailure(std::string("shade_pixels: ") + cudaGetErrorString(code));
    }
  };
  return std::make_shared<OnBoth>(shader);
}

}  // namespace gigabake::kernels
