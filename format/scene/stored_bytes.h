/// Sizes of the columns in a scene's shards. The totals of scenes before version 3 lack these sizes.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "format/scene/paged_scene.h"

namespace gigabake {

/// Compressed sizes of HDF5 columns on disk, in bytes. The rest of a shard is HDF5 headers, indexes and attributes.
struct StoredBytes {
  std::vector<std::uint64_t> of_lod;
  std::uint64_t of_nodes = 0;
};

/// Sums the sizes of all shards.
/// Cost    Opens every shard; reads no voxels.
/// Errors  InputError: a shard is missing or damaged.
StoredBytes stored_bytes(const PagedScene& scene, const Progress& progress = {});

}  // namespace gigabake
