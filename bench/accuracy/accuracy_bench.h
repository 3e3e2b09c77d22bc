/// Speed against error. The benchmark bakes a scene with each setting. It compares the baked voxels with the source's
/// triangles, and images of the voxels with images of the triangles.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/accuracy/accuracy_views.h"
#include "bench/accuracy/picture_error.h"
#include "bench/accuracy/voxel_error.h"
#include "bench/bench_scene.h"
#include "worker/device/backend.h"

namespace gigabake::bench {

struct AccuracyBenchRequest {
  BenchScene scene;  ///< with the parameters of the first setting
  /// The output folder. It receives images and one folder per setting; shards in these folders are replaced.
  std::filesystem::path out;
  Backend backend = Backend::automatic;
  int repeats = 3;                                   ///< bakes per setting; the minimum time is reported
  int samples = 64;                                  ///< rays per pixel of the reference
  std::vector<double> scales = accuracy_scales;      ///< voxels per pixel of the images
  int width = 160, height = 120;                     ///< maximum size of images
  VoxelErrorSample sample;                           ///< samples of the surface and of each setting's voxels
  std::vector<std::string> only;                     ///< names of the settings to bake; empty: all
  std::vector<double> steps_m = {12.9, 2.58, 0.86};  ///< metres per frame of bench_flight()
};

struct ViewError {
  std::string view;                   ///< AccuracyView::name()
  std::uint64_t compared_pixels = 0;  ///< pixels in which the reference shows the surface
  double render_s = 0;
  PictureError error;
  std::optional<double> lit_flip;  ///< FLIP of lit images; only if voxels are larger than pixels
};

struct AccuracySetting {
  std::string name;  ///< unique, such as "area-coverage-x2"; also the name of its folder
  std::string surface, mip;
  BakeParameters parameters;
  double bake_s = 0;  ///< from the sources to scene.xml, in one process
  std::uint64_t voxels = 0, bytes = 0;
  double render_s = 0;           ///< time for all views, including reading the scene
  std::uint64_t bytes_held = 0;  ///< max memory of pools and pages over the views, which are rendered in turn
  std::vector<ViewError> views;
  PictureError mean;  ///< means over the views
  VoxelError voxel;

  double voxels_per_s() const { return double(voxels) / bake_s; }
  double bytes_per_voxel() const { return double(bytes) / double(voxels); }
};

struct AccuracyBench {
  std::string backend;  ///< "cpu" or "cuda": the backend of the bake; images are always rendered by the CPU
  double voxel_size_m = 0;
  int samples = 0;
  double reference_s = 0;
  std::vector<AccuracyView> views;
  std::vector<AccuracySetting> settings;
};

/// Returns the names of all settings, in their order.
std::vector<std::string> accuracy_setting_names();

/// A callback that is called before each setting is baked.
using AccuracyProgress = std::function<void(const std::string& setting)>;

/// Measures every surface rule with every filter, at the voxel size and at twice the voxel size. Also measures variants
/// of the rule `area` with the filter `coverage`: without normals, without directional coverage, without both, with
/// several error bounds, and with LZ4. All settings use the same cameras. Voxels with equal content hashes are measured
/// once.
/// Errors  Same as a bake and ReferenceCaster's constructor. UsageError: `only` has a name that is not the name of a
///         setting. InputError: a view shows fewer than min_compared_pixels of the surface; then nothing is baked.
AccuracyBench bench_accuracy(const AccuracyBenchRequest& request, const AccuracyProgress& progress);

}  // namespace gigabake::bench
