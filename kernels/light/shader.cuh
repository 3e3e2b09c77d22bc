/// Shaders that run on the CPU and on a GPU (kernels/light/shader.h). Only files that nvcc compiles can include this
/// header.
#pragma once

#include <cuda_runtime.h>

#include "kernels/light/shader.h"
#include "kernels/marching/tile_grid.cuh"

namespace gigabake::kernels {

template <class Shader>
__global__ void shade_pixels(ShadedTile tile, Shader shader, CastRay* out) {
  int x, y;
  if (!pixel_of_thread(tile.tile, x, y)) return;
  const std::size_t i = std::size_t(y) * std::size_t(tile.tile.width) + std::size_t(x);
  out[i] = shaded_ray(tile, shader, i);
}

/// A shader for the CPU and for a GPU.
template <class Shader>
class DeviceShader final : public HostShader<Shader> {
 public:
  using HostShader<Shader>::HostShader;
  void on_device(const ShadedTile& tile, CastRay* out, void* stream) const override {
    shade_pixels<<<grid_of_tile(tile.tile), tile_threads, 0, static_cast<cudaStream_t>(stream)>>>(tile, this->shader(),
                                                                                                  out);
    if (const cudaError_t code = cudaGetLastError(); code != cudaSuccess)
      throw CudaFailure(std::string("shade_pixels: ") + cudaGetErrorString(code));
  }
};

template <class Shader>
std::shared_ptr<const SurfaceShader> device_shader(const Shader& shader) {
  return std::make_shared<DeviceShader<Shader>>(shader);
}

}  // namespace gigabake::kernels
