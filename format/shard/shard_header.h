/// Reading of a shard's header: the attributes of its root group.
#pragma once

#include "format/shard/hdf5/hdf5_file.h"
#include "format/shard/shard.h"

namespace gigabake {

/// Errors  InputError: not a shard, an unsupported version, or attributes that contradict each other.
ShardHeader read_header(const Hdf5File& file);
/// Returns the version of the format.
/// Errors  See read_header().
std::int32_t read_version(const Hdf5File& file);
/// Returns the attribute `above_hash`, which a shard has if it stores the downsample state.
/// Errors  InputError: malformed.
std::optional<Hash128> read_above_hash(const Hdf5File& file);

}  // namespace gigabake
