/// Sizes of the columns of a scene's shards, for scenes before version 3, whose totals lack them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "format/scene/paged_scene.h"

namespace gigabake {

/// Compressed sizes on disk. The rest of the shards' bytes is HDF5's own: headers, indexes, attributes.
struct StoredBytes {
  std::vector<std::uint64_t> of_lod;
  std::uint64_t of_nodes = 0;
};

/// Sums the sizes of all shards.
/// Cost    Opens every shard; reads no voxels.
/// Errors  InputError: a shard is missing or damaged.
StoredBytes stored_bytes(const PagedScene& scene, const Progress& progress = {});

}  // namespace gigabake
