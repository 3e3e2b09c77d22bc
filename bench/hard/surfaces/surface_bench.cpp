#include "bench/hard/surfaces/surface_bench.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "bench/accuracy/accuracy_views.h"
#include "bench/accuracy/leaks/sheet_mesh.h"
#include "bench/hard/surfaces/baked_surface.h"
#include "bench/hard/surfaces/surface_bounds.h"
#include "core/base/error.h"
#include "format/scene/xml/scene_xml.h"
#include "format/shard/levels/brick_walk.h"

namespace gigabake::bench {

BakedSurface::BakedSurface(const SurfaceScene& scene, const std::filesystem::path& folder, const HardMachine& machine)
    : folder_(folder) {
  const BenchScene bench = write_glb_scene(scene.model, folder, machine.threads);
  const SceneSources sources = open_sources(bench.source, bench.source_options);
  for (const CellReport& report : bake_scene(sources, bench, machine.cuda_device, folder))
    voxels_ += report.cell.voxels.at(0);
  FrameRenderer::Options options;
  options.threads = machine.threads;
  renderer_ = std::make_unique<FrameRenderer>(folder / "scene.xml", options);
}

void BakedSurface::for_each_normal(
    const std::function<void(const Vec3d& centre, const std::int8_t* normal)>& visit) const {
  for (const SceneCell& cell : read_scene(folder_ / "scene.xml").cells) {
    const Shard shard = read_shard(folder_ / cell.file);
    for_each_voxel_of_level(
        shard.nodes, shard.levels[0], 0,
        [&](std::int64_t x, std::int64_t y, std::int64_t z, const std::uint8_t*, const std::int8_t* normal) {
          visit(Vec3d(shard.header.lattice_min + Vec3i64{x, y, z}) + Vec3d::all(0.5), normal);
        });
  }
}

Picture BakedSurface::image(const CameraOptions& camera, ViewMode mode, Shadows shadows, const SunDirection& sun) {
  View view{camera, mode, {false, {0, 0, 0, 0}}, PictureLight::linear_too};
  view.shadows = shadows;
  view.sun = sun;
  Picture picture = renderer_->render_complete(view).picture;
  if (!renderer_->problems().empty()) throw InputError(folder_, "", renderer_->problems().front());
  return picture;
}

CameraOptions narrow_camera(const Vec3d& target, const Vec3d& direction, double voxels_per_pixel, int width,
                            int height) {
  CameraOptions camera;
  camera.fovy_deg = accuracy_fovy_deg;
  camera.width = width;
  camera.height = height;
  const double distance = voxels_per_pixel * height / (2 * std::tan(camera.fovy_deg * std::numbers::pi / 360));
  const Vec3d eye = target + direction * distance;
  camera.eye_m = {eye[0], eye[1], eye[2]};
  camera.target_m = {target[0], target[1], target[2]};
  return camera;
}

namespace {

/// Bakes a scene and measures it. A failure of the bake is part of the result.
template <class Scene, class Measure>
HardResult run_case(const Scene& scene, const std::filesystem::path& out, const HardMachine& machine,
                    const Measure& measure) {
  HardResult result;
  try {
    BakedSurface baked(scene, out / scene.name, machine);
    result = measure(baked);
    result.voxels = baked.voxels();
  } catch (const InputError& e) {
    result.error = e.what();
  }
  result.name = scene.name;
  result.group = surfaces_group;
  result.what = scene.what;
  return result;
}

}  // namespace

void run_surface_cases(const std::filesystem::path& out, const HardMachine& machine,
                       const std::function<void(HardResult&&)>& done) {
  const auto area = [&](const SurfaceScene& scene, const HardRange& goal) {
    done(run_case(scene, out, machine, [&](BakedSurface& baked) { return measure_area(scene, goal, baked); }));
  };
  area(town_scene(), area_of_town);
  constexpr double sizes[] = {0.1, 0.3, 1};
  for (const double thickness : sizes) area(thin_wires_scene(thickness), area_of_thin_objects);
  for (const LeafShape shape : {LeafShape::sheet, LeafShape::solid})
    for (const double edge : sizes) area(leaves_scene(shape, edge), area_of_thin_objects);
  for (const auto& [azimuth_deg, lean_deg] : {std::pair(0., 0.), {38.9, 0.}, {38.9, 20.}}) {
    const WallScene wall = thin_wall_scene(0.3, azimuth_deg, lean_deg);
    done(run_case(wall, out, machine, [&](BakedSurface& baked) { return measure_wall(wall, baked); }));
  }
  for (const auto& [thickness, azimuth_deg] : {std::pair(0., 17.9), {0.3, 0.}, {0.3, 17.9}, {2., 17.9}}) {
    const HouseScene house = closed_house_scene(thickness, azimuth_deg);
    done(run_case(house, out, machine, [&](BakedSurface& baked) { return measure_inside(house, baked); }));
  }
}

}  // namespace gigabake::bench
