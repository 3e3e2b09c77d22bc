#include "format/shard/columns/channels.h"

namespace gigabake {

std::string channel_names(bool has_normals, bool has_directional_coverage) {
  return std::string("rgba") + (has_normals ? " normal" : "") + (has_directional_coverage ? " facing" : "");
}

bool parse_channels(std::string_view text, bool& has_normals, bool& has_directional_coverage) {
  has_normals = text.find(" normal") != std::string_view::npos;
  has_directional_coverage = text.find(" facing") != std::string_view::npos;
  return text == channel_names(has_normals, has_directional_coverage);
}

}  // namespace gigabake
