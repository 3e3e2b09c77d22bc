/// Small GLB files and scenes of them, written for a test and removed after it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "format/source/source.h"
#include "lattice/parameters.h"
#include "worker/cell_pipeline.h"

namespace gigabake {

/// A folder under the system's temporary folder that goes with the test.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

struct GlbMesh {
  std::vector<float> position;  ///< glTF, y up
  std::vector<std::uint32_t> index;
  std::vector<float> uv;            ///< or empty: no texture
  std::vector<std::uint8_t> image;  ///< encoded; or empty
  std::string material = "{}";      ///< glTF material without its texture
};

/// 2·n² triangles, one metre a step, of rolling ground: x east, y up, z south.
GlbMesh rolling_ground(int n, double east_m, double north_m);

/// Returns a PNG of n×n texels, each with a different colour.
std::vector<std::uint8_t> checkered_png(int n);

void write_glb(const std::filesystem::path& path, const GlbMesh& mesh);

/// The reports of all jobs, in the order in which they come.
std::vector<CellReport> bake_all(CellPipeline& pipeline, const std::vector<CellJob>& jobs);

/// The files as tiles of a local scene.
SceneSources sources_of(const std::filesystem::path& folder, const std::vector<std::string>& files);

}  // namespace gigabake
