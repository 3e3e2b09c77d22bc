#include "bench/flight/flight_bench.h"

#include <algorithm>
#include <fmt/format.h>
#include <numbers>

#include "bench/accuracy/accuracy_scene.h"
#include "bench/flight/flight_path.h"
#include "bench/flight/mesh_baseline.h"
#include "core/base/error.h"
#include "viewer/light/sky.h"

namespace gigabake::bench {
namespace {

constexpr std::size_t min_frames = 4, max_frames = 100000;

/// The scene, the renderer and the path of one run.
struct FlightScene {
  const AccuracyBenchRequest& request;
  const AccuracyProgress& progress;
  const AccuracyScene& scene;
  FrameRenderer::Options renderer;
  FlightArea area;

  std::filesystem::path file() const { return request.out / "scene.xml"; }
};

/// Returns the area of the triangles. Its ground is the highest surface at places of the orbit, so that the eye is
/// above the surface.
FlightArea area_of(const ReferenceCaster& caster, const BakeParameters& lattice) {
  constexpr int places = 720;
  const TriangleBox& box = caster.box();
  const Vec3d centre = box.centre(), size = box.max - box.min;
  FlightArea area{to_scene_m(centre, lattice), std::max(size[0], size[1]) * lattice.voxel_size_m, 0,
                  lattice.voxel_size_m};
  double ground = box.min[2];
  for (int i = 0; i < places; ++i) {
    const Point<Scene> eye_m = *orbit_view(area, 2 * std::numbers::pi * i / places, 1, 1).camera.eye_m;
    const Vec3d eye = (Vec3d{eye_m.x, eye_m.y, eye_m.z} - lattice.lattice_origin_m) / lattice.voxel_size_m;
    const Vec3d above{eye[0], eye[1], box.max[2] + 1};
    if (const auto down = caster.first_hit(above, {0, 0, -1})) ground = std::max(ground, above[2] - *down);
  }
  area.ground_m = to_scene_m({0, 0, ground}, lattice).z;
  return area;
}

std::vector<double> angles_of(const FlightArea& area, double step_m) {
  std::vector<double> angles = orbit_angles(area, step_m);
  if (angles.size() < min_frames || angles.size() > max_frames)
    throw UsageError(fmt::format("--steps: an orbit of {:.4g} m in steps of {:g} m has {} frames; expected {} to {}",
                                 orbit_length_m(area), step_m, angles.size(), min_frames, max_frames));
  return angles;
}

void add_flights(const FlightScene& s, FlightBench& bench) {
  for (const double step_m : s.request.steps_m) {
    std::vector<View> views;
    for (const double angle : angles_of(s.area, step_m))
      views.push_back(orbit_view(s.area, angle, s.request.width, s.request.height));
    for (const double rate : flight_rates) {
      s.progress(fmt::format("{:g} m per frame at {:g} Hz", step_m, rate));
      const FlightPace pace{0.5 / rate, 1 / rate, true};
      bench.flights.push_back({step_m, rate, fly(s.file(), s.renderer, views, pace, flight_exact_frames)});
    }
  }
}

LinearPicture triangles_in(const ReferenceCaster& caster, const kernels::CastCamera& camera, ViewMode mode,
                           int samples) {
  if (mode == ViewMode::albedo) return caster.draw(camera, samples);
  return on_screen(caster.draw(camera, samples, afternoon_light()));
}

StillError still_error(const LinearPicture& reference, const LinearPicture& picture) {
  const PictureError error = picture_error(reference, picture);
  return {error.psnr_black_db, error.flip};
}

/// Compares voxels and mesh from one camera, without and with light.
void add_still(const FlightScene& s, const MeshBaseline& baseline, double at, FlightBench& bench) {
  const CameraOptions options = orbit_view(s.area, 2 * std::numbers::pi * at, s.request.width, s.request.height).camera;
  const kernels::CastCamera camera = reference_camera(options, s.request.scene.parameters);
  const MeshChoice choice = baseline.choose(camera, mesh_pixel_error);
  const ReferenceCaster mesh(s.scene.caster.triangles().with_indices(choice.indices), s.request.scene.threads);
  for (const ViewMode mode : {ViewMode::albedo, ViewMode::lit}) {
    StillRow row{at, std::string(name_of(mode)), 0, {}, {}, 0, choice.triangles, choice.bytes};
    s.progress(fmt::format("still image {:.2f}, {}", at, row.mode));
    const LinearPicture reference = triangles_in(s.scene.caster, camera, mode, s.request.samples);
    row.compared_pixels = compared_pixels(reference);
    expect_surface(s.request.scene.source, fmt::format("orbit {:.2f}", at), row.compared_pixels);
    FrameRenderer renderer(s.file(), s.renderer);
    const Frame frame = renderer.render_complete({options, mode, {false, {0, 0, 0, 0}}});
    row.voxels = still_error(reference, to_linear(frame.picture));
    row.voxel_bytes = frame.stats.bytes_held;
    row.mesh = still_error(reference, triangles_in(mesh, camera, mode, s.request.samples));
    bench.stills.push_back(row);
    if (!renderer.problems().empty()) throw InputError(s.request.out, "", renderer.problems().front());
  }
}

}  // namespace

FlightBench bench_flight(const AccuracyBenchRequest& request, const AccuracyProgress& progress) {
  if (!has_mesh_levels())
    throw UsageError(
        "--flight: this gigabake was built without meshoptimizer; install libmeshoptimizer-dev and build again");
  const AccuracyScene scene(request, progress);
  FlightScene s{request, progress, scene, scene.renderer, area_of(scene.caster, request.scene.parameters)};
  s.renderer.cuda_device = choose_device({request.backend}).device;
  FlightBench bench{request.scene.source.string(),
                    s.renderer.cuda_device ? "cuda" : "cpu",
                    request.scene.parameters.voxel_size_m,
                    orbit_length_m(s.area),
                    request.samples,
                    request.width,
                    request.height,
                    request.scene.threads,
                    0,
                    {},
                    {}};
  for (const double step_m : request.steps_m) angles_of(s.area, step_m);
  progress("levels of the mesh");
  const MeshBaseline baseline(scene.caster.triangles(), request.scene.threads);
  bench.source_triangles = baseline.source_triangles();
  for (int i = 0; i < flight_stills; ++i) add_still(s, baseline, double(i) / flight_stills, bench);
  add_flights(s, bench);
  return bench;
}

}  // namespace gigabake::bench
