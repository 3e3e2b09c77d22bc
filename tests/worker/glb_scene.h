/// Small GLB files and scenes of them, written for a test and removed after it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/octree/parameters.h"
#include "format/source/source.h"
#include "worker/pipeline/cell_pipeline.h"

namespace gigabake {

/// A folder below the system's temporary folder that is removed with the test.
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
  std::vector<float> uv;            ///< empty if there is no texture
  std::vector<std::uint8_t> image;  ///< encoded image; may be empty
  std::string material = "{}";      ///< glTF material without its texture
  std::vector<float> normal = {};   ///< empty, or one per vertex; requires `uv`
  std::string extensions = "{}";    ///< of the primitive
};

/// Returns rolling ground of 2·n² triangles with one metre per step: x east, y up, z south.
GlbMesh rolling_ground(int n, double east_m, double north_m);

/// Returns a PNG of n×n texels, each with a different colour.
std::vector<std::uint8_t> checkered_png(int n);

void write_glb(const std::filesystem::path& path, const GlbMesh& mesh);

/// Bakes all jobs. Returns the reports by rising job, because several threads publish shards in any order.
std::vector<CellReport> bake_all(CellPipeline& pipeline, const std::vector<CellJob>& jobs);

/// Returns the files as tiles of a local scene.
SceneSources sources_of(const std::filesystem::path& folder, const std::vector<std::string>& files);

}  // namespace gigabake
