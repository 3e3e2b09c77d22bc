/// Names of a voxel's channels in shards and scenes: "rgba", then optionally "normal" and "facing".
#pragma once

#include <string>
#include <string_view>

namespace gigabake {

std::string channel_names(bool has_normals, bool has_directional_coverage);
/// Parses a result of channel_names(). Returns false for any other text.
bool parse_channels(std::string_view text, bool& has_normals, bool& has_directional_coverage);

}  // namespace gigabake
