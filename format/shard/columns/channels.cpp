#include "format/shard/columns/channels.h"

namespace gigabake {

std::string channel_names(const VoxelChannels& channels) {
  return std::string("rgba") + (channels.normals ? " normal" : "") + (channels.directional_coverage ? " facing" : "") +
         (channels.classes ? " class" : "");
}

std::optional<VoxelChannels> parse_channels(std::string_view text) {
  const auto has = [&](std::string_view name) { return text.find(name) != std::string_view::npos; };
  const VoxelChannels channels{has(" normal"), has(" facing"), has(" class")};
  return text == channel_names(channels) ? std::optional(channels) : std::nullopt;
}

}  // namespace gigabake
