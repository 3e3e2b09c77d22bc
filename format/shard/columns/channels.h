/// Names of a voxel's channels in shards and scenes: "rgba", then optionally "normal", "facing" and "class".
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gigabake {

/// The optional channels of a voxel.
struct VoxelChannels {
  bool normals = false, directional_coverage = false, classes = false;
  friend bool operator==(const VoxelChannels&, const VoxelChannels&) = default;
};

std::string channel_names(const VoxelChannels& channels);
/// Parses a result of channel_names(). Returns nullopt for any other text.
std::optional<VoxelChannels> parse_channels(std::string_view text);

}  // namespace gigabake
