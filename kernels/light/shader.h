/// Shaders that light or colour a surface: functors that are called once per pixel, after the pixel's rays are
/// finished.
///
/// A shader is a copyable value with
///
///     GB_HD void operator()(const SurfacePoint& at, float rgb[3]) const;
///
/// It computes the light that the surface sends: linear RGB, premultiplied by `at.there`. host_shader() compiles a
/// shader for the CPU only. device_shader() (kernels/light/shader.cuh, for files that nvcc compiles) compiles a shader
/// for the CPU and for a GPU. A shader must use IEEE float and double without transcendental functions, so that the CPU
/// and the GPU return the same bits.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/base/error.h"
#include "core/base/host_device.h"
#include "core/base/thread_pool.h"
#include "kernels/light/lighting.h"
#include "kernels/light/surface_point.h"
#include "kernels/marching/cast_ray.h"

namespace gigabake::kernels {

/// The finished pixels of a tile. The pointers refer to the caster's memory.
struct ShadedTile {
  const CastRay* rays;
  const PixelLight* lights;
  CastTile tile;
  CastLighting lighting;
  Vec3d eye;
};

/// A shader in the form that casters call.
class SurfaceShader {
 public:
  virtual ~SurfaceShader() = default;
  /// Shades all pixels of the tile into `out`.
  virtual void on_host(const ShadedTile& tile, CastRay* out, const ThreadPool& policy) const = 0;
  /// Shades the tile on a device, like on_host(). `stream` is a cudaStream_t.
  /// Errors  CudaFailure.
  virtual void on_device(const ShadedTile& tile, CastRay* out, void* stream) const = 0;
};

/// A shader that lights voxels by the sun and the sky.
struct LitShader {
  CastLight light;
  CastLightPart part = CastLightPart::all;

  GB_HD void operator()(const SurfacePoint& at, float rgb[3]) const {
    const float sun = at.facing * at.sun_seen;
    for (int k = 0; k < 3; ++k) {
      float irradiance = 0;
      if (part != CastLightPart::sky) irradiance += light.sun[k] * sun;
      if (part != CastLightPart::sun) irradiance += light.sky[k] * at.sky_seen + light.ground[k] * (1 - at.sky_seen);
      rgb[k] = part == CastLightPart::shadow ? at.there * at.sun_seen : at.own[k] * irradiance;
    }
  }
};

/// Interpolates between `count` colours, spaced evenly over place 0 to 1. Clamps `place` to this range.
GB_HD void colour_between(const float (*colours)[3], int count, float place, float rgb[3]) {
  const float at = (place > 0 ? (place < 1 ? place : 1) : 0) * float(count - 1);
  const int first = int(at) < count - 2 ? int(at) : count - 2;
  const float share = at - float(first);
  for (int k = 0; k < 3; ++k) rgb[k] = colours[first][k] + (colours[first + 1][k] - colours[first][k]) * share;
}

/// Returns the brightness of relief shading, as on maps: surfaces that face north-west and up are brightest.
GB_HD float relief(const Vec3<float>& normal) {
  const float facing = (normal[1] - normal[0]) * 0.5f + normal[2] * 0.70710678f;
  return 0.35f + 0.65f * (facing > 0 ? facing : 0);
}

/// A shader that colours surfaces by their height between `low` and `high`: from blue through green, yellow and brown
/// to white.
struct HeightShader {
  double low = 0, high = 1;  ///< z in lod-0 voxels; low < high

  GB_HD void operator()(const SurfacePoint& at, float rgb[3]) const {
    constexpr float colours[5][3] = {{0.02f, 0.12f, 0.45f},
                                     {0.03f, 0.35f, 0.08f},
                                     {0.75f, 0.65f, 0.12f},
                                     {0.30f, 0.10f, 0.03f},
                                     {0.95f, 0.95f, 0.95f}};
    colour_between(colours, 5, float((at.place[2] - low) / (high - low)), rgb);
    for (int k = 0; k < 3; ++k) rgb[k] *= at.there * relief(at.normal);
  }
};

/// A shader that colours surfaces by the tangent of their slope. The colours are green at 0, yellow at 1/2 (27°), red
/// at 1 (45°), and very dark red from 2 (63°) on. Overhangs are violet.
struct SlopeShader {
  GB_HD void operator()(const SurfacePoint& at, float rgb[3]) const {
    constexpr float colours[5][3] = {{0.02f, 0.40f, 0.05f},
                                     {0.80f, 0.70f, 0.05f},
                                     {0.80f, 0.08f, 0.03f},
                                     {0.45f, 0.03f, 0.02f},
                                     {0.20f, 0.01f, 0.01f}};
    const float z = at.normal[2], level = 1 - z * z;
    const float tangent = z > 0 ? std::sqrt(level > 0 ? level : 0) / z : 2;
    colour_between(colours, 5, tangent * 0.5f, rgb);
    if (z < 0) rgb[0] = 0.25f, rgb[1] = 0.02f, rgb[2] = 0.45f;
    for (int k = 0; k < 3; ++k) rgb[k] *= at.there * (0.6f + 0.4f * relief(at.normal));
  }
};

/// Shades pixel i of the tile.
template <class Shader>
GB_HD CastRay shaded_ray(const ShadedTile& tile, const Shader& shader, std::size_t i) {
  CastRay out = tile.rays[i];
  if (!(out.transmittance < 1)) return out;
  const SurfacePoint at = surface_point(out, tile.eye, {tile.lights, tile.tile}, tile.lighting, i);
  const CastHaze& haze = tile.lighting.haze;
  const float through = exp_minus(at.distance * haze.per_voxel);
  Vec3<float> rgb;
  shader(at, rgb.v);
  for (int k = 0; k < 3; ++k) out.rgb[k] = rgb[k] * through + haze.rgb[k] * (at.there * (1 - through));
  return out;
}

template <class Shader>
void shade_on_host(const ShadedTile& tile, const Shader& shader, CastRay* out, const ThreadPool& policy) {
  constexpr std::size_t per_range = 1024;
  const std::size_t pixels = std::size_t(tile.tile.width) * std::size_t(tile.tile.height);
  policy.parallel_for(pixels, per_range, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) out[i] = shaded_ray(tile, shader, i);
  });
}

/// A shader for the CPU only: on a device it throws CudaFailure.
template <class Shader>
class HostShader : public SurfaceShader {
 public:
  explicit HostShader(const Shader& shader) : shader_(shader) {}
  void on_host(const ShadedTile& tile, CastRay* out, const ThreadPool& policy) const override {
    shade_on_host(tile, shader_, out, policy);
  }
  void on_device(const ShadedTile&, CastRay*, void*) const override {
    throw CudaFailure("the shader was compiled for the CPU only; cast there, or create it with device_shader()");
  }

 protected:
  const Shader& shader() const { return shader_; }

 private:
  Shader shader_;
};

template <class Shader>
std::shared_ptr<const SurfaceShader> host_shader(const Shader& shader) {
  return std::make_shared<HostShader<Shader>>(shader);
}

/// Creates a built-in shader for the CPU and for a GPU; in a build without CUDA, for the CPU only.
std::shared_ptr<const SurfaceShader> lit_shader(const LitShader& shader);
std::shared_ptr<const SurfaceShader> height_shader(const HeightShader& shader);
std::shared_ptr<const SurfaceShader> slope_shader(const SlopeShader& shader);

}  // namespace gigabake::kernels
