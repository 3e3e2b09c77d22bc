/// Sums over a scene's cells and parents.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "format/scene/scene_xml.h"
#include "lattice/progress.h"

namespace gigabake {

/// What scene.xml says. Indexed by lod, up to the highest that any cell has.
struct SceneTotals {
  explicit SceneTotals(const SceneDescription& scene);
  std::vector<std::uint64_t> voxels;
  std::vector<Hash128> content_hash;
  Hash128 all_content;  ///< of all lods
  std::uint64_t bytes = 0;

 private:
  void add(const SceneCell& cell);
};

/// Compressed sizes on disk. The rest of the shards' bytes is HDF5's own: headers, indexes, attributes.
struct StoredBytes {
  std::vector<std::uint64_t> of_lod;
  std::uint64_t of_nodes = 0;
};

/// Cost    Opens every shard, reads no voxels. Errors  InputError: a shard is missing or damaged.
StoredBytes stored_bytes(const std::filesystem::path& scene_xml, const SceneDescription& scene,
                         const Progress& progress = {});

}  // namespace gigabake
