/// Losses of tiles that cannot be read.
#pragma once

#include <string>

#include "format/scene/xml/scene_xml.h"

namespace gigabake {

/// Returns the reason of a loss without the file name at its beginning, if that is the name of the lost tile. A message
/// with the tile's name then contains the name only once. Otherwise returns an empty text.
std::string reason_without_tile(const SceneLoss& loss);

}  // namespace gigabake
