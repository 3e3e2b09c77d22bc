/// Shards in temporary files, for callers that publish several shards at the same time (format/system/publish.h).
#pragma once

#include <filesystem>

#include "format/shard/packed_shard.h"
#include "format/shard/shard.h"

namespace gigabake {

/// Writes the shard to the empty file `temporary`. Messages name `path`, which is the file's path after publication.
/// Exact, Cost, Errors: see write_shard() and write_packed_shard(), without the flushes.
StoredShard write_temporary_shard(const std::filesystem::path& temporary, const std::filesystem::path& path,
                                  const Shard& shard, const ShardWriteOptions& options);
StoredShard write_temporary_shard(const std::filesystem::path& temporary, const std::filesystem::path& path,
                                  const PackedShard& shard, const ShardWriteOptions& options);

}  // namespace gigabake
