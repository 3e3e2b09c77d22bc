/// What levels above a shard are made of, as its file keeps it: group `/above` (docs/format.md).
#pragma once

#include <filesystem>

#include "format/shard/shard.h"

namespace gigabake {

/// XXH3-128 (seed 0) of the columns' bytes, in the order of ParentSource.
Hash128 hash_of(const ParentSource& above);

/// Columns that fit each other; places inside of their level, the coarsest level's first; no voxel without coverage.
/// Errors  InputError: file, column, row, what is wrong.
void check_above(const std::filesystem::path& path, const ShardHeader& header, const ParentSource& above);

}  // namespace gigabake
