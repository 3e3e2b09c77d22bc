/// Light leaks. The benchmark uses default settings to bake scenes whose true alpha is known. It renders these scenes
/// from all elevations and distances.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "bench/accuracy/leaks/leak_error.h"
#include "bench/accuracy/leaks/leak_eye.h"
#include "bench/bench_scene.h"
#include "worker/device/backend.h"

namespace gigabake::bench {

enum class LeakSuite {
  whole,
  few_planes,  ///< three planes, three elevations, 4 and 16 voxels per pixel
};

struct LeakBenchRequest {
  std::filesystem::path out;  ///< a folder for each scene
  bool keep = false;          ///< keep scenes and images
  Backend backend = Backend::automatic;
  int threads = 1;
  LeakSuite suite = LeakSuite::whole;
  std::vector<std::string> families;  ///< names of the families to measure; empty: all
  int edge = 1536;                    ///< width of generated scenes in voxels; farther views need wider scenes
  int samples = 64;                   ///< rays per pixel of the traced reference
  int width = 160, height = 120;      ///< of images
};

/// The errors of one image.
struct LeakRow {
  double elevation_deg = 0, voxels_per_pixel = 0;
  LeakEye eye = LeakEye::anywhere;
  LeakError error;
};

struct LeakResult {
  std::string name, family, what;
  bool is_opaque = true;  ///< alpha is 1 at every inner pixel
  std::uint64_t voxels = 0;
  std::vector<LeakRow> rows;
  std::string not_measured;   ///< the reason why there are no rows, or empty
  bool needs_embree = false;  ///< there are no rows because this build has no Embree
};

struct LeakBench {
  std::string backend;        ///< "cpu" or "cuda": the backend of the bake; images are always rendered by the CPU
  int edge = 0, samples = 0;  ///< edge 0: a scene of the user
  std::vector<LeakResult> scenes;
  /// Returns true if no view of an opaque surface leaks more light than docs/accuracy-rendering.md allows.
  bool is_bounded() const;
  /// Returns the names of scenes whose views together show fewer than min_inner_pixels inner pixels. Omits scenes that
  /// need Embree.
  std::vector<std::string> unmeasured() const;
};

/// The minimum number of inner pixels in all views of a scene together; fewer pixels do not suffice to measure leaks.
inline constexpr std::size_t min_inner_pixels = 100;

/// Returns the families of scenes, in their order.
std::vector<std::string> leak_families();

/// A callback that is called before each scene is baked.
using LeakProgress = std::function<void(const std::string& scene)>;

/// Measures the leaks of the generated scenes.
/// Cost    Bakes about 3·edge² voxels of level 0 per scene, 62 scenes, and renders up to 71 images of each.
/// Errors  Same as a bake. Without Embree, scenes with a traced reference are reported as not measured.
LeakBench bench_leaks(const LeakBenchRequest& request, const LeakProgress& progress);

/// Measures the leaks of the user's scene from the same cameras. A pixel is inner if all traced rays in this pixel and
/// in its neighbours hit opaque surfaces.
/// Errors  Same as a bake. UsageError: built without Embree.
LeakBench bench_leaks_of(const BenchScene& scene, const LeakBenchRequest& request);

}  // namespace gigabake::bench
