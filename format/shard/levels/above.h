/// The downsample state that a shard's file stores for building coarser levels: group `/above` (docs/format.md).
#pragma once

#include <filesystem>

#include "format/shard/shard.h"

namespace gigabake {

/// Returns the XXH3-128 hash (seed 0) of the columns' bytes, in the order of DownsampleState's members.
Hash128 hash_of(const DownsampleState& above);

/// Checks the columns: their lengths match, and each position lies inside its level. Voxels of the coarsest level
/// precede all others, and no voxel has zero coverage.
/// Errors  InputError naming file, column, row and broken rule.
void check_above(const std::filesystem::path& path, const ShardHeader& header, const DownsampleState& above);

}  // namespace gigabake
