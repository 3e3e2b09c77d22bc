/// Reading of a shard's header: the attributes of its root group.
#pragma once

#include "format/shard/hdf5/hdf5_file.h"
#include "format/shard/shard.h"

namespace gigabake {

/// Errors  InputError: the file is not a shard, its version is not supported, or its attributes contradict each other.
ShardHeader read_header(const Hdf5File& file);
/// Returns the version of the format.
/// Errors  See read_header().
std::int32_t read_version(const Hdf5File& file);
/// Returns the attribute `above_hash`. Only shards that store the downsample state have this attribute.
/// Errors  InputError: the attribute is malformed.
std::optional<Hash128> read_above_hash(const Hdf5File& file);

}  // namespace gigabake
