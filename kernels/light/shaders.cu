#include "kernels/light/shader.cuh"

namespace gigabake::kernels {

std::shared_ptr<const SurfaceShader> lit_shader(const LitShader& shader) { return device_shader(shader); }
std::shared_ptr<const SurfaceShader> height_shader(const HeightShader& shader) { return device_shader(shader); }
std::shared_ptr<const SurfaceShader> slope_shader(const SlopeShader& shader) { return device_shader(shader); }

}  // namespace gigabake::kernels
