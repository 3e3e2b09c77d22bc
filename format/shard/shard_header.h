/// What a shard says of itself: the attributes of its root group.
#pragma once

#include "format/shard/hdf5/hdf5_file.h"
#include "format/shard/shard.h"

namespace gigabake {

/// Errors  InputError: not a shard, of a version that we do not know, or attributes that do not fit each other.
ShardHeader read_header(const Hdf5File& file);
/// Of the format. Errors  as read_header().
std::int32_t read_version(const Hdf5File& file);
/// `above_hash`, which a shard has that keeps what levels above are made of. Errors  InputError: malformed.
std::optional<Hash128> read_above_hash(const Hdf5File& file);

}  // namespace gigabake
