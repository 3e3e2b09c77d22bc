/// Whether a shard is the one that its scene means.
#pragma once

#include <string>
#include <vector>

#include "format/scene_xml.h"
#include "format/shard.h"

namespace gigabake {

/// An attribute that differs, and in what.
struct HeaderDifference {
  std::string attribute, what;
};

/// Empty where the header is what `scene` says of `cell`.
std::vector<HeaderDifference> differences_from_scene(const ShardHeader& header, const SceneDescription& scene,
                                                     const SceneCell& cell);

}  // namespace gigabake
