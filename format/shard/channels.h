/// What a voxel of a shard says, as shards and scenes name it: "rgba", then perhaps "normal" and "facing".
#pragma once

#include <string>
#include <string_view>

namespace gigabake {

std::string channel_names(bool has_normals, bool has_facing);
/// False where the text names anything else, or in another order.
bool parse_channels(std::string_view text, bool& has_normals, bool& has_facing);

}  // namespace gigabake
