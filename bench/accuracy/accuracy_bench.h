/// Speed against error: bakes a scene with one setting after the other, and holds its voxels against the triangles
/// themselves and pictures of each against pictures of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/accuracy/accuracy_views.h"
#include "bench/accuracy/normal_bits.h"
#include "bench/accuracy/picture_error.h"
#include "bench/accuracy/voxel_error.h"
#include "bench/bench_scene.h"
#include "worker/backend.h"

namespace gigabake::bench {

struct AccuracyBenchRequest {
  BenchScene scene;  ///< its parameters are those of the first setting
  /// A folder for each setting, whose shards are replaced, and pictures.
  std::filesystem::path out;
  Backend backend = Backend::automatic;
  int repeats = 3;                               ///< bakes of each setting; the fastest counts
  int samples = 64;                              ///< of the reference, a pixel
  std::vector<double> scales = accuracy_scales;  ///< of the pictures, voxels a pixel
  int width = 160, height = 120;                 ///< of the largest pictures
  VoxelErrorSample sample;                       ///< of the source's surface and of each setting's voxels
  std::vector<std::string> only;                 ///< settings to bake, by their names; empty: all
};

struct ViewError {
  std::string view;                   ///< AccuracyView::name()
  std::uint64_t compared_pixels = 0;  ///< in which the reference shows the surface
  double render_s = 0;
  PictureError error;
  std::optional<double> lit_flip;  ///< in the light of `render`, where voxels are larger than pixels
};

struct AccuracySetting {
  std::string name;  ///< "area-coverage-x2": unique, and its folder's
  std::string surface, mip;
  BakeParameters parameters;
  double bake_s = 0;  ///< from the sources to scene.xml, in one process
  std::uint64_t voxels = 0, bytes = 0;
  double render_s = 0;  ///< of all views, with what it takes to read the scene
  std::vector<ViewError> views;
  PictureError mean;  ///< over the views
  VoxelError voxel;

  double voxels_per_s() const { return double(voxels) / bake_s; }
  double bytes_per_voxel() const { return double(bytes) / double(voxels); }
};

struct AccuracyBench {
  std::string backend;  ///< "cpu" or "cuda": where cells were baked; pictures are drawn by the CPU
  double voxel_size_m = 0;
  int samples = 0;
  double reference_s = 0;
  std::vector<AccuracyView> views;
  std::vector<AccuracySetting> settings;
  std::vector<NormalBits> normals;  ///< of the first setting's shards, where there are pictures at a voxel a pixel
};

/// Of all settings, in their order.
std::vector<std::string> accuracy_setting_names();

/// Told of each setting before it is baked.
using AccuracyProgress = std::function<void(const std::string& setting)>;

/// Every surface rule with every filter, at the voxel size and at twice that; and area with coverage without normals,
/// without facing, without either, with several largest errors, and with LZ4.
/// All settings are seen from the same cameras. Voxels that are the same by their content hashes are looked at once.
/// Errors  as a bake, and as ReferenceCaster's; UsageError: no setting has such a name. InputError: a view shows
///         fewer than min_compared_pixels of the surface; nothing is baked then.
AccuracyBench bench_accuracy(const AccuracyBenchRequest& request, const AccuracyProgress& progress);

}  // namespace gigabake::bench
