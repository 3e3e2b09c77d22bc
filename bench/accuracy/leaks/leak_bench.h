/// Leaks: scenes whose true alpha is known, baked with default settings and looked at from every elevation and
/// distance.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "bench/accuracy/leaks/leak_error.h"
#include "bench/accuracy/leaks/leak_eye.h"
#include "bench/bench_scene.h"
#include "worker/backend.h"

namespace gigabake::bench {

enum class LeakSuite {
  whole,
  few_planes,  ///< three planes, three elevations, 4 and 16 voxels a pixel
};

struct LeakBenchRequest {
  std::filesystem::path out;  ///< a folder for each scene
  bool keep = false;          ///< scenes and pictures stay there
  Backend backend = Backend::automatic;
  int threads = 1;
  LeakSuite suite = LeakSuite::whole;
  std::vector<std::string> families;  ///< to look at, by their names; empty: all
  int edge = 1536;                    ///< how wide made scenes are, in voxels: farther views need wider ones
  int samples = 64;                   ///< of the traced reference, a pixel
  int width = 160, height = 120;      ///< of pictures
};

/// One picture.
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
  std::string not_measured;   ///< why there are no rows, or empty
  bool needs_embree = false;  ///< there are no rows because this build has no Embree
};

struct LeakBench {
  std::string backend;        ///< "cpu" or "cuda": where cells were baked; pictures are drawn by the CPU
  int edge = 0, samples = 0;  ///< edge 0: a scene that was given
  std::vector<LeakResult> scenes;
  /// No opaque surface lets more light through than docs/accuracy-rendering.md allows, in any view.
  bool is_bounded() const;
  /// Returns the scenes whose views together show fewer than min_inner_pixels; without those that need Embree.
  std::vector<std::string> unmeasured() const;
};

/// A scene with fewer inner pixels in all its views together says nothing about leaks.
inline constexpr std::size_t min_inner_pixels = 100;

/// Kinds of scenes, in their order.
std::vector<std::string> leak_families();

/// Told of each scene before it is baked.
using LeakProgress = std::function<void(const std::string& scene)>;

/// Cost    Bakes some 3·edge² voxels of level 0 a scene, 33 scenes, and draws up to 63 pictures of each.
/// Errors  As a bake. Without Embree the scenes whose reference is traced say that they are not measured.
LeakBench bench_leaks(const LeakBenchRequest& request, const LeakProgress& progress);

/// The same cameras before a scene of one's own. Inside is what no traced ray passes in a pixel and its neighbours.
/// Errors  As a bake; UsageError: built without Embree.
LeakBench bench_leaks_of(const BenchScene& scene, const LeakBenchRequest& request);

}  // namespace gigabake::bench
