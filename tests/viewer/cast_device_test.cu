// Rays see the same bits on a GPU and on the CPU. Skipped, with a message, where there is no GPU.
#include <cmath>
#include <cstring>
#include <deque>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <vector>

#include "kernels/cast.h"
#include "viewer/cast_pages.h"
#include "viewer/cell_layout.h"
#include "viewer/sky.h"
#include "voxel_scene.h"

namespace gigabake {
namespace {

using kernels::CastCamera;
using kernels::CastRay;
using kernels::CastScene;

void check(cudaError_t code, const char* call) {
  if (code != cudaSuccess) throw std::runtime_error(std::string(call) + ": " + cudaGetErrorString(code));
}

/// Copies of host arrays on the device, freed together.
class DeviceCopies {
 public:
  DeviceCopies() = default;
  DeviceCopies(const DeviceCopies&) = delete;
  DeviceCopies& operator=(const DeviceCopies&) = delete;
  ~DeviceCopies() {
    for (void* p : owned_) cudaFree(p);
  }

  template <class T>
  T* copy(const std::vector<T>& host) {
    if (host.empty()) return nullptr;
    void* p = nullptr;
    check(cudaMalloc(&p, host.size() * sizeof(T)), "cudaMalloc");
    owned_.push_back(p);
    check(cudaMemcpy(p, host.data(), host.size() * sizeof(T), cudaMemcpyHostToDevice), "cudaMemcpy");
    return static_cast<T*>(p);
  }

 private:
  std::vector<void*> owned_;
};

/// A scene with every page here, twice.
struct WholeScene {
  std::deque<NodePage> nodes;
  std::deque<LevelPage> levels;
  std::vector<std::uint32_t> used;
  CellLayout host;
  CastScene device;
  DeviceCopies copies;

  explicit WholeScene(const VoxelScene& voxels)
      : used((kernels::max_cast_lods + 1) * voxels.description().cells.size()),
        host(lay_out_cells(voxels.description(), "scene.xml")) {
    const Shading shading(afternoon_light(), voxels.description());
    const kernels::CpuPolicy policy(1);
    std::vector<kernels::CastCell> device_cells = host.cells;
    for (std::size_t c = 0; c < host.cells.size(); ++c) {
      const std::size_t cell = host.scene_cell[c];
      const NodePage& page = nodes.emplace_back(make_node_page(voxels.reader().nodes(cell), host.scene.lods, shading));
      host.cells[c].nodes = page.nodes.data();
      host.cells[c].constants = page.constants.data();
      device_cells[c].nodes = copies.copy(page.nodes);
      device_cells[c].constants = copies.copy(page.constants);
      for (int lod = 0; lod < host.scene.lods; ++lod) {
        const LevelPage& level = levels.emplace_back(
            make_level_page(voxels.reader().level(cell, lod), lod, page.bricks[std::size_t(lod)], shading, policy));
        host.cells[c].level[lod] = {level.bricks.data(), level.voxels.data()};
        device_cells[c].level[lod] = {copies.copy(level.bricks), copies.copy(level.voxels)};
      }
    }
    host.scene.page_used = used.data();
    device = host.scene;
    device.cells.data = copies.copy(device_cells);
    device.column_key.data = copies.copy(host.column_key);
    device.column_first.data = copies.copy(host.column_first);
    device.page_used = copies.copy(used);
  }
};

__global__ void cast_pixels(CastScene scene, CastCamera camera, CastRay* rays) {
  const int i = int(blockIdx.x * blockDim.x + threadIdx.x);
  if (i >= camera.width * camera.height) return;
  const kernels::CastLine line = line_of_sight(scene, camera, i % camera.width, i / camera.width);
  rays[i] = start_ray(scene, line);
  cast_ray(scene, camera, line, rays[i]);
}

std::vector<CastRay> cast_on_device(WholeScene& scene, const CastCamera& camera) {
  std::vector<CastRay> rays(std::size_t(camera.width) * std::size_t(camera.height));
  CastRay* device_rays = scene.copies.copy(rays);
  cast_pixels<<<unsigned(rays.size() + 127) / 128, 128>>>(scene.device, camera, device_rays);
  check(cudaGetLastError(), "cast_pixels");
  check(cudaMemcpy(rays.data(), device_rays, rays.size() * sizeof(CastRay), cudaMemcpyDeviceToHost), "cudaMemcpy");
  return rays;
}

std::vector<CastRay> cast_on_host(const WholeScene& scene, const CastCamera& camera) {
  std::vector<CastRay> rays(std::size_t(camera.width) * std::size_t(camera.height));
  const kernels::CpuPolicy policy(2);
  const kernels::CastTile tile{0, 0, camera.width, camera.height};
  start_rays(scene.host.scene, camera, tile, {rays.data(), rays.size()}, policy);
  cast_rays(scene.host.scene, camera, tile, {rays.data(), rays.size()}, policy);
  return rays;
}

/// A translucent, coloured, rough ball that reaches through eight cells.
std::optional<Paint> rough_ball(std::int64_t x, std::int64_t y, std::int64_t z) {
  std::uint64_t h = std::uint64_t((x * 73856093) ^ (y * 19349663) ^ (z * 83492791)) * 0x9e3779b97f4a7c15ull;
  h ^= h >> 29;
  if (std::hypot(double(x) - 31, double(y) - 33, double(z) - 30) > 27 || (h & 1) != 0) return {};
  return Paint{{std::uint8_t(h >> 8), std::uint8_t(h >> 16), std::uint8_t(h >> 24), std::uint8_t((h >> 32 & 127) + 1)},
               {std::int8_t(h >> 40 & 63), std::int8_t(h >> 48 & 63)}};
}

TEST(CastOnDevice, ReturnsTheSameBitsAsOnTheHost) {
  int devices = 0;
  if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) GTEST_SKIP() << "no GPU on this machine";
  VoxelScene voxels(32);
  voxels.add_cells(rough_ball, {0, 0, 0}, 64);
  WholeScene scene(voxels);
  for (const std::array<double, 3>& eye : {std::array{120.0, -40.0, 80.0}, std::array{31.5, 31.5, 90.0},
                                           std::array{32.0, 32.0, 32.0}, std::array{900.0, 700.0, 400.0}}) {
    CastCamera camera = make_camera(view(eye, {30, 31, 29.5}, 200).camera, voxels.description(), voxels.reader());
    camera.haze = air(scene.host.scene);
    const std::vector<CastRay> host = cast_on_host(scene, camera), device = cast_on_device(scene, camera);
    int different = 0, seen = 0;
    for (std::size_t i = 0; i < host.size(); ++i) {
      seen += host[i].transmittance < 1;
      different += std::memcmp(host[i].rgb, device[i].rgb, sizeof host[i].rgb) != 0 ||
                   host[i].transmittance != device[i].transmittance || device[i].lod != -1;
    }
    EXPECT_GT(seen, 100);
    EXPECT_EQ(different, 0) << "of " << host.size() << " rays";
  }
}

}  // namespace
}  // namespace gigabake
