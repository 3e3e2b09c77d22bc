// Images have the same bits on a GPU and on the CPU. The tests are skipped, with a message, if there is no GPU.
#include <cmath>
#include <gtest/gtest.h>

#include "kernels/cuda/baker.h"
#include "tests/viewer/voxel_scene.h"
#include "viewer/light/sky.h"
#include "viewer/pictures/render.h"

namespace gigabake {
namespace {

/// Paints a translucent, coloured, rough ball that extends over eight cells.
std::optional<Paint> rough_ball(std::int64_t x, std::int64_t y, std::int64_t z) {
  std::uint64_t h = std::uint64_t((x * 73856093) ^ (y * 19349663) ^ (z * 83492791)) * 0x9e3779b97f4a7c15ull;
  h ^= h >> 29;
  if (std::hypot(double(x) - 31, double(y) - 33, double(z) - 30) > 27 || (h & 1) != 0) return {};
  return Paint{{std::uint8_t(h >> 8), std::uint8_t(h >> 16), std::uint8_t(h >> 24), std::uint8_t((h >> 32 & 127) + 1)},
               {std::int8_t(h >> 40 & 63), std::int8_t(h >> 48 & 63)}};
}

Picture draw(const VoxelScene& scene, const std::array<double, 3>& eye, std::uint64_t pool_bytes,
             std::optional<int> device, const std::optional<kernels::CastLighting>& light = {}, const Clip& clip = {},
             const RenderSettings* look = nullptr, const kernels::CastPolygons& polygons = {}, int edge = 200) {
  const ThreadPool policy(2);
  SceneStream::Options options;
  options.light = light ? kernels::unlit() : afternoon_light();
  options.memory_bytes = std::uint64_t(1) << 26;
  options.cuda_device = device;
  options.device_bytes = pool_bytes;
  SceneStream stream(scene.paged(), scene.pages(), options, policy);
  CameraOptions wish = view(eye, {30, 31, 29.5}, edge).camera;
  wish.clip = clip;
  kernels::CastCamera camera = make_camera(wish, scene.paged());
  if (!light) camera.haze = air(600, 1);
  camera.tone = screen_tone(0.5);
  camera.polygons = polygons;
  if (look) return render(stream, camera, *look, PictureLight::linear_too);
  return render(stream, camera, {}, PictureLight::linear_too, light);
}

TEST(CastOnDevice, ReturnsTheSameBitsAsOnTheHostForAnyPool) {
  const kernels::CudaDevices devices = kernels::cuda_devices();
  if (devices.usable.empty()) GTEST_SKIP() << "no GPU: " << devices.reason;
  VoxelScene scene(32);
  scene.add_cells(rough_ball, {0, 0, 0}, 64);
  for (const std::array<double, 3>& eye : {std::array{120.0, -40.0, 80.0}, std::array{31.5, 31.5, 90.0},
                                           std::array{32.0, 32.0, 32.0}, std::array{900.0, 700.0, 400.0}}) {
    const Picture host = draw(scene, eye, 0, {});
    for (const std::uint64_t pool : {std::uint64_t(1) << 19, std::uint64_t(1) << 26}) {
      const Picture device = draw(scene, eye, pool, devices.usable[0]);
      EXPECT_EQ(host.rgba, device.rgba) << pool;
      EXPECT_EQ(host.depth, device.depth) << pool;
      EXPECT_EQ(host.linear, device.linear) << pool;
    }
  }
}

TEST(CastOnDevice, ReturnsTheSameBitsWhereManyRaysNeedManyRounds) {
  const kernels::CudaDevices devices = kernels::cuda_devices();
  if (devices.usable.empty()) GTEST_SKIP() << "no GPU: " << devices.reason;
  VoxelScene scene(32);
  scene.add_cells(rough_ball, {0, 0, 0}, 64);
  const auto drawn = [&](std::optional<int> device) {
    return draw(scene, {32, 32, 32}, std::uint64_t(1) << 26, device, {}, {}, nullptr, {}, 900);
  };
  const Picture host = drawn({}), device = drawn(devices.usable[0]);
  EXPECT_EQ(host.rgba, device.rgba);
  EXPECT_EQ(host.depth, device.depth);
}

TEST(CastOnDevice, ShadowsHaveTheSameBitsAsOnTheHostForAnyPool) {
  const kernels::CudaDevices devices = kernels::cuda_devices();
  if (devices.usable.empty()) GTEST_SKIP() << "no GPU: " << devices.reason;
  VoxelScene scene(32);
  scene.add_cells(rough_ball, {0, 0, 0}, 64);
  for (const kernels::CastLightPart part : {kernels::CastLightPart::all, kernels::CastLightPart::shadow})
    for (const std::array<double, 3>& eye : {std::array{120.0, -40.0, 80.0}, std::array{900.0, 700.0, 400.0}}) {
      const kernels::CastLighting light = lighting({200, 30}, part, air(600, 1));
      const Picture host = draw(scene, eye, 0, {}, light);
      for (const std::uint64_t pool : {std::uint64_t(1) << 19, std::uint64_t(1) << 26}) {
        const Picture device = draw(scene, eye, pool, devices.usable[0], light);
        EXPECT_EQ(host.rgba, device.rgba) << pool;
        EXPECT_EQ(host.linear, device.linear) << pool;
      }
    }
}

TEST(CastOnDevice, ClipsWithTheSameBitsAsOnTheHost) {
  const kernels::CudaDevices devices = kernels::cuda_devices();
  if (devices.usable.empty()) GTEST_SKIP() << "no GPU: " << devices.reason;
  VoxelScene scene(32);
  scene.add_cells(rough_ball, {0, 0, 0}, 64);
  const Clip clip{.box_m = {{Point<Scene>{5, 5, 5}, Point<Scene>{60, 50.5, 55}}},
                  .plane = ClipPlane{{30, 30, 30}, {1, -2, 0.5}}};
  for (const std::array<double, 3>& eye : {std::array{120.0, -40.0, 80.0}, std::array{32.0, 32.0, 32.0}}) {
    const Picture host = draw(scene, eye, 0, {}, {}, clip);
    const Picture device = draw(scene, eye, std::uint64_t(1) << 26, devices.usable[0], {}, clip);
    EXPECT_EQ(host.rgba, device.rgba);
    EXPECT_EQ(host.depth, device.depth);
    EXPECT_EQ(host.linear, device.linear);
  }
}

TEST(CastOnDevice, BlendsLevelsShadesAndHidesBehindPolygonsWithTheSameBitsAsOnTheHost) {
  const kernels::CudaDevices devices = kernels::cuda_devices();
  if (devices.usable.empty()) GTEST_SKIP() << "no GPU: " << devices.reason;
  VoxelScene scene(32);
  scene.add_cells(rough_ball, {0, 0, 0}, 64);
  const std::size_t pixels = 200 * 200;
  std::vector<float> distance(pixels, kernels::CastPolygons::nowhere), rgba(4 * pixels, 0.5f);
  for (std::size_t i = 0; i < pixels; i += 3) distance[i] = 500 + float(i % 1000);
  const kernels::CastLighting unshadowed = lighting({200, 30}, kernels::CastLightPart::unshadowed, air(600, 1));
  const kernels::CastLighting all = lighting({200, 30}, kernels::CastLightPart::all, {});
  const RenderSettings looks[] = {{.background = {}, .blends_levels = true},
                                  {.background = {}, .lighting = all, .blends_levels = true},
                                  {.background = {}, .lighting = unshadowed, .shader = kernels::height_shader({0, 64})},
                                  {.background = {}, .lighting = unshadowed, .shader = kernels::slope_shader({})}};
  for (const RenderSettings& look : looks)
    for (const std::array<double, 3>& eye : {std::array{120.0, -40.0, 80.0}, std::array{900.0, 700.0, 400.0}}) {
      const kernels::CastPolygons polygons{distance.data(), rgba.data()};
      const auto drawn = [&](std::uint64_t pool, std::optional<int> device) {
        return draw(scene, eye, pool, device, look.lighting, {}, &look, polygons);
      };
      const Picture host = drawn(0, {});
      for (const std::uint64_t pool : {std::uint64_t(1) << 19, std::uint64_t(1) << 26}) {
        const Picture device = drawn(pool, devices.usable[0]);
        EXPECT_EQ(host.rgba, device.rgba) << pool;
        EXPECT_EQ(host.depth, device.depth) << pool;
        EXPECT_EQ(host.linear, device.linear) << pool;
      }
    }
}

}  // namespace
}  // namespace gigabake
