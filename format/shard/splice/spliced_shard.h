/// A shard that takes most bricks of a stored shard, and replaces the others.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "format/shard/shard.h"
#include "format/shard/splice/spliced_rows.h"

namespace gigabake {

struct SplicedShard {
  ShardHeader header;
  NodeTable nodes;
  std::vector<SplicedLevel> levels;  ///< [lod]; a new brick's parent is new too, or constant
  DownsampleState above;
};

/// Sizes of a spliced shard on disk, in bytes.
struct StoredSplice {
  StoredShard stored;
  std::uint64_t copied = 0;  ///< of `stored.file`: chunks that were copied as stored
};

/// Writes the shard like write_shard().
/// Exact   Same bytes as write_shard() for the same voxels. Copies chunks as stored if their rows are the rows of a
///         chunk of the base.
/// Range   base.is_spliceable(), and `options.codec` is the codec of the base.
/// Cost    Writes the complete file. Packs a column from its first changed row on, because a brick with another number
///         of rows moves all later rows. If no brick changes its number of rows, packs only chunks with new bricks.
/// Errors  InputError: see write_shard(). InputError: the base is damaged.
StoredSplice write_spliced_shard(const std::filesystem::path& path, const SplicedShard& shard, const BaseShard& base,
                                 const ShardWriteOptions& options);

}  // namespace gigabake
