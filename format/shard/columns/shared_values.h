/// Values that voxels of a brick share, in shards of versions 2 to 6. The rules are in core/codec/shared_value.h.
#pragma once

#include <cstdint>
#include <span>

#include "core/codec/shared_value.h"
#include "format/shard/columns/voxel_channel.h"

namespace gigabake {

/// Expands the brick's values to its voxels. `mask` has 8 words, `share` has share_bytes, and `to` has one entry per
/// bit set in `mask`. Returns false if the number of values in `value`, of `width` bytes each, differs from the number
/// that `share` implies. The entries of `to` are then unspecified.
bool spread_values(const std::uint64_t* mask, const std::uint8_t* share, std::span<const std::uint8_t> value,
                   std::size_t width, ChannelBytes<std::uint8_t> to);

}  // namespace gigabake
